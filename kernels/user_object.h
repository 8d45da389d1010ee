/* Objects whose shape a user wrote in OpenCL C (kernels/MATH.md, "Shapes that users write"). The
 * snippets are plain scalar code and are called lane by lane; each is a translation unit of its
 * own, so that no name of theirs reaches this code. */
#ifndef SONJECT_KERNELS_USER_OBJECT_H
#define SONJECT_KERNELS_USER_OBJECT_H

#include "interval.h"
#include "layout.h"

/* They call the snippet of a number; lib/user/snippet.c writes them. */
float user_distance(int snippet, float3 point, float3 direction, float nearest,
                    const float *parameters);
float3 user_normal(int snippet, float3 point, const float *parameters);

/* Normals are asked for within so many bounding radii. */
#define USER_REACH 1.01f

FUNCTION GLOBAL const struct user_record *user_of_object(GLOBAL const struct object_record *object)
{
    return (GLOBAL const struct user_record *)((GLOBAL const RECORD_WORD *)object +
                                               object->mesh_words);
}

/* A snippet reads its own copy, in the address space that plain pointers have. */
FUNCTION void copy_user_parameters(GLOBAL const struct user_record *user, float *parameters)
{
    for (int i = 0; i < USER_PARAMETERS; i++)
        parameters[i] = user->parameters[i];
}

struct user_lanes {
    float x[WIDTH], y[WIDTH], z[WIDTH];
};

FUNCTION void store_user_lanes(struct user_lanes *lanes, struct vector3 v)
{
    STORE_VFLOAT(v.x, lanes->x);
    STORE_VFLOAT(v.y, lanes->y);
    STORE_VFLOAT(v.z, lanes->z);
}

FUNCTION float3 user_lane(const struct user_lanes *lanes, int lane)
{
    return (float3)(lanes->x[lane], lanes->y[lane], lanes->z[lane]);
}

/* Distance from the ray's closest approach `start`, in the object's own frame, to the first surface
 * beyond `minimum`; FAR_AWAY if there is none, or the ray is not wanted. Snippets are asked about
 * the part of the ray within the bounding sphere. */
NOINLINE vfloat user_object_distance(GLOBAL const struct object_record *object,
                                     struct vector3 start, struct vector3 direction, vfloat minimum,
                                     mask is_wanted)
{
    GLOBAL const struct user_record *user = user_of_object(object);
    const vfloat beyond = larger(minimum, SPLAT(-object->bounding_radius));
    const mask is_asked = is_wanted & MASK_OF(beyond < object->bounding_radius);
    float parameters[USER_PARAMETERS];
    struct user_lanes points, ways;
    float nearest[WIDTH], met[WIDTH];
    int asked[WIDTH];
    copy_user_parameters(user, parameters);
    store_user_lanes(&points, start);
    store_user_lanes(&ways, direction);
    STORE_VFLOAT(beyond, nearest);
    STORE_VINT(is_asked, asked);
    for (int lane = 0; lane < WIDTH; lane++) {
        met[lane] = FAR_AWAY;
        if (!asked[lane])
            continue;
        const float distance = user_distance(user->snippet, user_lane(&points, lane),
                                             user_lane(&ways, lane), nearest[lane], parameters);
        if (distance > nearest[lane] && distance < FAR_AWAY)
            met[lane] = distance;
    }
    return LOAD_VFLOAT(met);
}

/* Outward unit normal at a hit, both in the object's own frame; not a number where the snippet
 * gives none, which the tallies then report. Lanes far from the object get what does no harm. */
NOINLINE struct vector3 user_object_normal(GLOBAL const struct object_record *object,
                                           struct vector3 hit, struct vector3 direction)
{
    GLOBAL const struct user_record *user = user_of_object(object);
    const float reach = USER_REACH * object->bounding_radius;
    const mask is_near = MASK_OF(dot3(hit, hit) <= reach * reach);
    float parameters[USER_PARAMETERS];
    struct user_lanes points, normals;
    int near[WIDTH];
    copy_user_parameters(user, parameters);
    store_user_lanes(&points, hit);
    store_user_lanes(&normals, reversed3(direction));
    STORE_VINT(is_near, near);
    for (int lane = 0; lane < WIDTH; lane++) {
        if (!near[lane])
            continue;
        const float3 normal = user_normal(user->snippet, user_lane(&points, lane), parameters);
        normals.x[lane] = normal.x;
        normals.y[lane] = normal.y;
        normals.z[lane] = normal.z;
    }
    struct vector3 normal;
    normal.x = LOAD_VFLOAT(normals.x);
    normal.y = LOAD_VFLOAT(normals.y);
    normal.z = LOAD_VFLOAT(normals.z);
    /* of any length: by the largest component first, so that no square overflows */
    const vfloat largest =
        larger(larger(magnitude(normal.x), magnitude(normal.y)), magnitude(normal.z));
    normal.x = normal.x / largest;
    normal.y = normal.y / largest;
    normal.z = normal.z / largest;
    const vfloat length = SQUARE_ROOT(dot3(normal, normal));
    normal.x = normal.x / length;
    normal.y = normal.y / length;
    normal.z = normal.z / length;
    if (user->is_open)
        normal = choose3(MASK_OF(dot3(normal, direction) > 0.0f), reversed3(normal), normal);
    return normal;
}

#endif
