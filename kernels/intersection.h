/* Intersections of rays with objects. */
#ifndef SONJECT_KERNELS_INTERSECTION_H
#define SONJECT_KERNELS_INTERSECTION_H

#include "interval.h"
#include "layout.h"
#include "mesh_ray.h" /* boxes, which many objects need too */
#define SHAPE_FILES
#include "shapes/shapes.h"
#if HAS_MESHES
#include "mesh_object.h"
#endif

/* Turns a vector of the launch's frame into the object's own frame. */
FUNCTION struct vector3 into_object(GLOBAL const struct object_record *object, struct vector3 v)
{
    return vector3_of(v.x * object->axes[0] + v.y * object->axes[1] + v.z * object->axes[2],
                      v.x * object->axes[3] + v.y * object->axes[4] + v.z * object->axes[5],
                      v.x * object->axes[6] + v.y * object->axes[7] + v.z * object->axes[8]);
}

FUNCTION struct vector3 out_of_object(GLOBAL const struct object_record *object, struct vector3 v)
{
    return vector3_of(v.x * object->axes[0] + v.y * object->axes[3] + v.z * object->axes[6],
                      v.x * object->axes[1] + v.y * object->axes[4] + v.z * object->axes[7],
                      v.x * object->axes[2] + v.y * object->axes[5] + v.z * object->axes[8]);
}

FUNCTION struct vector3 from_centre(GLOBAL const struct object_record *object, struct vector3 point)
{
    return vector3_of(point.x - object->centre_x, point.y - object->centre_y,
                      point.z - object->centre_z);
}

#define SHAPE_ONE(NUMBER, name, traits) +1
/* Returns whether the object has one of the plainest shapes. */
FUNCTION int is_plain(GLOBAL const struct object_record *object)
{
    return object->shape < 0 PLAIN_SHAPES(SHAPE_ONE);
}

#define SHAPE_INTERVAL(NUMBER, name, traits)                                                       \
    case SHAPE_##NUMBER:                                                                           \
        return name##_interval(object, point, direction);
#define SHAPE_SPANS(NUMBER, name, traits)                                                          \
    case SHAPE_##NUMBER:                                                                           \
        return name##_spans(object, point, direction);
#define SHAPE_NORMAL(NUMBER, name, traits)                                                         \
    case SHAPE_##NUMBER:                                                                           \
        return name##_normal(object, point, direction);
#define SHAPE_CONVEX(NUMBER, name, traits)                                                         \
    case SHAPE_##NUMBER:                                                                           \
        return !((traits)&SHAPE_IS_HOLLOW);

/* Returns the interval of a plain shape, in the object's own frame. */
FUNCTION struct interval plain_interval(GLOBAL const struct object_record *object,
                                        struct vector3 point, struct vector3 direction)
{
    switch (object->shape) {
    default:
        PLAIN_SHAPES(SHAPE_INTERVAL)
    }
}

/* Returns the intervals of any shape, in the object's own frame. */
NOINLINE struct spans shape_spans(GLOBAL const struct object_record *object, struct vector3 point,
                                  struct vector3 direction)
{
    switch (object->shape) {
        OTHER_SHAPES(SHAPE_SPANS)
        ENDED_CYLINDERS(SHAPE_SPANS)
    default:
        return spans_of_one(plain_interval(object, point, direction));
    }
}

/* Returns whether a straight way that leaves the outer side never meets the object again. */
FUNCTION int is_convex(GLOBAL const struct object_record *object)
{
    switch (object->shape) {
    default:
        PLAIN_SHAPES(SHAPE_CONVEX)
        OTHER_SHAPES(SHAPE_CONVEX)
        SCENE_SHAPES(SHAPE_CONVEX)
        ENDED_CYLINDERS(SHAPE_CONVEX)
    }
}

/* Returns the outward unit normal of a plain shape, in the object's own frame. */
FUNCTION struct vector3 plain_normal(GLOBAL const struct object_record *object,
                                     struct vector3 point, struct vector3 direction)
{
    switch (object->shape) {
    default:
        PLAIN_SHAPES(SHAPE_NORMAL)
    }
}

/* Returns the normal of any shape; without an inside, on the side that the ray comes from. */
NOINLINE struct vector3 shape_normal(GLOBAL const struct object_record *object,
                                     struct vector3 point, struct vector3 direction)
{
    switch (object->shape) {
        OTHER_SHAPES(SHAPE_NORMAL)
        ENDED_CYLINDERS(SHAPE_NORMAL)
    default:
        return plain_normal(object, point, direction);
    }
}

/* Returns the first end beyond `minimum` of an interval that counts from `start`, else FAR_AWAY. */
FUNCTION vfloat first_end_beyond(struct interval inside, vfloat start, vfloat minimum)
{
    const vfloat entry = start + inside.entry;
    const vfloat exit = start + inside.exit;
    const vfloat first = SELECT(MASK_OF(entry > minimum), entry,
                                SELECT(MASK_OF(exit > minimum), exit, SPLAT(FAR_AWAY)));
    return SELECT(MASK_OF(inside.entry <= inside.exit), first, SPLAT(FAR_AWAY));
}

/* Returns the distance along the ray to the first surface beyond `minimum`, FAR_AWAY if there is
 * none. The ray first moves to its closest approach to the object. Single precision then holds the
 * shape and not the range, even at 500 m. */
FUNCTION vfloat object_distance(GLOBAL const struct object_record *object, struct vector3 point,
                                struct vector3 direction, vfloat minimum)
{
    const struct vector3 relative = from_centre(object, point);
    const vfloat approach = -dot3(relative, direction);
    const struct vector3 closest = along3(relative, direction, approach);
    const mask is_near =
        MASK_OF(dot3(closest, closest) <= object->bounding_radius * object->bounding_radius);
    if (!ANY(is_near))
        return SPLAT(FAR_AWAY);
    const struct vector3 start = into_object(object, closest);
    const struct vector3 step = into_object(object, direction);
    if (is_plain(object))
        return first_end_beyond(plain_interval(object, start, step), approach, minimum);
#if HAS_MESHES
    if (object->shape == SHAPE_MESH) {
        const vfloat beyond = minimum - approach;
        const vfloat farthest = SELECT(is_near, SPLAT(FAR_AWAY), beyond - 1.0f);
        return approach + mesh_object_distance(object, start, step, beyond, farthest);
    }
#endif
    const struct spans inside = shape_spans(object, start, step);
    return smaller(first_end_beyond(inside.first, approach, minimum),
                   first_end_beyond(inside.second, approach, minimum));
}

#if HAS_MESHES
/* Returns the surface of a mesh where the ray meets it, in the object's own frame. */
FUNCTION struct mesh_surface surface_of_mesh(GLOBAL const struct object_record *object,
                                             struct vector3 point, struct vector3 direction,
                                             vfloat distance)
{
    const struct vector3 relative = from_centre(object, point);
    const vfloat approach = -dot3(relative, direction);
    const struct vector3 start = into_object(object, along3(relative, direction, approach));
    const struct vector3 step = into_object(object, direction);
    return mesh_object_surface(object, start, step, distance - approach);
}
#endif

/* Returns the outward unit normal where the ray meets the object, at the distance that
 * object_distance gave. A mesh has its facet's normal: physical optics integrates over facets. */
FUNCTION struct vector3 object_normal(GLOBAL const struct object_record *object,
                                      struct vector3 point, struct vector3 direction,
                                      vfloat distance)
{
#if HAS_MESHES
    if (object->shape == SHAPE_MESH)
        return out_of_object(object, surface_of_mesh(object, point, direction, distance).facet);
#endif
    const struct vector3 hit =
        into_object(object, from_centre(object, along3(point, direction, distance)));
    const struct vector3 step = into_object(object, direction);
    return out_of_object(object, is_plain(object) ? plain_normal(object, hit, step)
                                                  : shape_normal(object, hit, step));
}

/* The purpose of a normal. The two differ where facets stand for a smooth surface. */
enum wanted_face {
    FACE_OF_OPTICS,
    FACE_OF_SCATTERING
};

/* A surface where a ray meets it. For scattering, a mesh that stands for a smooth surface has the
 * smooth normal. All else has the normal of object_normal. */
struct surface_face {
    struct vector3 normal;
#if HAS_MESHES
    struct vector3 lift; /* way from the hit to the start of rays that test visibility, m */
#endif
};

FUNCTION struct surface_face object_face(GLOBAL const struct object_record *object,
                                         enum wanted_face wanted, struct vector3 point,
                                         struct vector3 direction, vfloat distance)
{
    struct surface_face face;
#if HAS_MESHES
    if (object->shape == SHAPE_MESH && wanted == FACE_OF_SCATTERING) {
        const struct mesh_surface surface = surface_of_mesh(object, point, direction, distance);
        face.normal = out_of_object(object, surface.smooth);
        face.lift = out_of_object(object, minus3(surface.lifted, surface.point));
        return face;
    }
    face.lift = zero3();
#endif
    (void)wanted;
    face.normal = object_normal(object, point, direction, distance);
    return face;
}

/* Returns a point of the surface, moved off it so far that its facets throw no shadows. */
FUNCTION struct vector3 lifted_point(struct vector3 point, const struct surface_face *face)
{
#if HAS_MESHES
    return along3(point, face->lift, SPLAT(1.0f));
#else
    (void)face;
    return point;
#endif
}

FUNCTION struct surface_face choose_face(mask condition, struct surface_face yes,
                                         struct surface_face no)
{
    struct surface_face face;
    face.normal = choose3(condition, yes.normal, no.normal);
#if HAS_MESHES
    face.lift = choose3(condition, yes.lift, no.lift);
#endif
    return face;
}

struct nearest_hit {
    vfloat distance; /* FAR_AWAY: none */
    vint object;     /* number, -1: none */
};

#include "object_tree.h"

/* The step of rays off a surface, m: more than a hit's rounding, less than what throws shadows. */
#define START_OFF_SURFACE 2.0e-5f

FUNCTION struct nearest_hit find_nearest_hit(GLOBAL const struct object_record *objects, int count,
                                             struct vector3 point, struct vector3 direction,
                                             float minimum)
{
    struct nearest_hit nearest;
    if (has_object_tree(objects, count)) {
        const struct object_search search = {SPLAT(FAR_AWAY), 0, SPLAT_VINT(-1), SPLAT_VINT(-1)};
        return search_objects(objects, count, point, direction, minimum, &search);
    }
    nearest.distance = SPLAT(FAR_AWAY);
    nearest.object = VINT_OF(SPLAT(-1.0f));
    for (int i = 0; i < count; i++) {
        const vfloat distance = object_distance(&objects[i], point, direction, SPLAT(minimum));
        const mask is_nearer = MASK_OF(distance < nearest.distance);
        nearest.distance = SELECT(is_nearer, distance, nearest.distance);
        nearest.object = SELECT(is_nearer, VINT_OF(SPLAT((float)i)), nearest.object);
    }
    return nearest;
}

/* Returns a distance beyond `path` if nothing is in the way up to `path`, else one within it. */
FUNCTION vfloat find_obstacle(GLOBAL const struct object_record *objects, int count,
                              struct vector3 point, struct vector3 direction, vfloat path)
{
    if (has_object_tree(objects, count)) {
        const struct object_search search = {path, 1, SPLAT_VINT(-1), SPLAT_VINT(-1)};
        return search_objects(objects, count, point, direction, 0.0f, &search).distance;
    }
    return find_nearest_hit(objects, count, point, direction, 0.0f).distance;
}

#endif
