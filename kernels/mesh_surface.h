/* The surface of a mesh where rays meet it. */
#ifndef SONJECT_KERNELS_MESH_SURFACE_H
#define SONJECT_KERNELS_MESH_SURFACE_H

#include "mesh.h"

/* The smallest cosine between the smooth normal and the way back along a ray, unless the facet's
 * own is smaller. */
#define MESH_LEAST_COSINE 0.01f

struct mesh_surface {
    struct vector3 point;  /* point on the facet, in the mesh's frame */
    struct vector3 facet;  /* unit normal of the facet, outward */
    struct vector3 smooth; /* unit normal of the smooth surface, outward; without such a surface,
                              the facet's */
    /* The point moved off the facet onto the smooth surface, on the side that the ray came from.
     * Rays that test visibility start here, so that facets throw no shadows that the smooth surface
     * would not throw. */
    struct vector3 lifted;
};

/* Gathers the corners of each lane's triangle. Number -1 stands for triangle 0. */
FUNCTION struct mesh_corners gather_corners(struct mesh_view mesh, const int *triangles)
{
    float a[3][WIDTH], b[3][WIDTH], c[3][WIDTH];
    for (int lane = 0; lane < WIDTH; lane++) {
        const int number = triangles[lane] < 0 ? 0 : triangles[lane];
        GLOBAL const struct mesh_leaf *leaf = &mesh.leaves[number / MESH_SLOTS];
        const int slot = number % MESH_SLOTS;
        for (int axis = 0; axis < 3; axis++) {
            a[axis][lane] = leaf->a[axis][slot];
            b[axis][lane] = leaf->b[axis][slot];
            c[axis][lane] = leaf->c[axis][slot];
        }
    }
    struct mesh_corners corners;
    corners.a = load_lanes3(a);
    corners.b = load_lanes3(b);
    corners.c = load_lanes3(c);
    return corners;
}

/* Gathers the smooth surface's normals at the corners of each lane's triangle. */
FUNCTION struct mesh_corners gather_normals(struct mesh_view mesh, const int *triangles)
{
    float a[3][WIDTH], b[3][WIDTH], c[3][WIDTH];
    for (int lane = 0; lane < WIDTH; lane++) {
        GLOBAL const struct mesh_corner_normals *normals =
            &mesh.normals[triangles[lane] < 0 ? 0 : triangles[lane]];
        for (int axis = 0; axis < 3; axis++) {
            a[axis][lane] = normals->a[axis];
            b[axis][lane] = normals->b[axis];
            c[axis][lane] = normals->c[axis];
        }
    }
    struct mesh_corners corners;
    corners.a = load_lanes3(a);
    corners.b = load_lanes3(b);
    corners.c = load_lanes3(c);
    return corners;
}

/* Returns the unit vector along v, or `otherwise` if v is 0. v is first divided by its largest
 * component, so that squares neither vanish nor overflow. */
FUNCTION struct vector3 unit3(struct vector3 v, struct vector3 otherwise)
{
    const vfloat largest = larger(larger(magnitude(v.x), magnitude(v.y)), magnitude(v.z));
    const mask is_some = MASK_OF(largest > 0.0f);
    const vfloat safe = SELECT(is_some, largest, SPLAT(1.0f));
    v = divided3(v, safe);
    const vfloat length = SQUARE_ROOT(SELECT(is_some, dot3(v, v), SPLAT(1.0f)));
    v = divided3(v, length);
    return choose3(is_some, v, otherwise);
}

FUNCTION struct vector3 cross3(struct vector3 a, struct vector3 b)
{
    return vector3_of(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

/* Returns a point's depth below the plane through a corner, along its normal times side; >= 0. */
FUNCTION vfloat depth_below(struct vector3 point, struct vector3 corner, struct vector3 normal,
                            vfloat side)
{
    return larger(-side * dot3(minus3(point, corner), normal), SPLAT(0.0f));
}

/* Bends the normal towards the way back along the ray if it would show a side that the ray did not
 * meet. */
FUNCTION struct vector3 bend_to_ray(struct vector3 normal, struct vector3 facet,
                                    struct vector3 direction, vfloat side)
{
    const vfloat facet_cosine = -side * dot3(facet, direction);
    const vfloat least = smaller(SPLAT(MESH_LEAST_COSINE), facet_cosine);
    const vfloat lack = larger(least + side * dot3(normal, direction), SPLAT(0.0f));
    return unit3(along3(normal, direction, -side * lack), facet);
}

/* Returns the surface where rays meet the numbered triangles. point: the rays' closest approach to
 * the frame's origin; direction: unit. Lanes with the number -1 get some finite values. */
FUNCTION struct mesh_surface mesh_surface_at(struct mesh_view mesh, struct vector3 point,
                                             struct vector3 direction, vint triangle)
{
    int triangles[WIDTH];
    STORE_VINT(triangle, triangles);
    const vint own_z = own_z_of(direction);
    const struct mesh_ray ray = mesh_ray_of(point, direction, own_z, SPLAT(0.0f), 0.0f);
    const struct mesh_corners corners = gather_corners(mesh, triangles);
    struct mesh_corners seen;
    seen.a = seen_along(&ray, in_own_axes(corners.a, own_z));
    seen.b = seen_along(&ray, in_own_axes(corners.b, own_z));
    seen.c = seen_along(&ray, in_own_axes(corners.c, own_z));
    const struct vector3 edges = edge_functions(&seen);
    const vfloat sum = edges.x + edges.y + edges.z;
    const mask is_met = MASK_OF(sum != 0.0f) & MASK_OF(triangle >= 0);
    const vfloat safe = SELECT(is_met, sum, SPLAT(1.0f));
    const vfloat a = SELECT(is_met, edges.x / safe, SPLAT(1.0f));
    const vfloat b = SELECT(is_met, edges.y / safe, SPLAT(0.0f));
    const vfloat c = SELECT(is_met, edges.z / safe, SPLAT(0.0f));
    struct mesh_surface surface;
    surface.point = combine3(corners.a, a, corners.b, b, corners.c, c);
    surface.facet = unit3(cross3(minus3(corners.b, corners.a), minus3(corners.c, corners.a)),
                          reversed3(direction));
    surface.smooth = surface.facet;
    surface.lifted = surface.point;
    if (!mesh.normals)
        return surface;
    const struct mesh_corners normals = gather_normals(mesh, triangles);
    const vfloat side =
        SELECT(MASK_OF(dot3(surface.facet, direction) > 0.0f), SPLAT(-1.0f), SPLAT(1.0f));
    const struct vector3 mixed =
        unit3(combine3(normals.a, a, normals.b, b, normals.c, c), surface.facet);
    const mask is_outward = MASK_OF(dot3(mixed, surface.facet) > 0.0f);
    surface.smooth =
        bend_to_ray(choose3(is_outward, mixed, surface.facet), surface.facet, direction, side);
    /* Lifts onto the planes that touch the smooth surface at the corners, mixed by a, b and c. */
    const struct vector3 lift =
        combine3(normals.a, a * depth_below(surface.point, corners.a, normals.a, side), normals.b,
                 b * depth_below(surface.point, corners.b, normals.b, side), normals.c,
                 c * depth_below(surface.point, corners.c, normals.c, side));
    surface.lifted = along3(surface.point, lift, side);
    return surface;
}

#endif
