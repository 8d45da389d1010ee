/* Intersections of rays with one box and one triangle of a mesh. Ray and triangle both have a value
 * in each lane. A packet of rays against one triangle, and one ray against several, give the same
 * bits. */
#ifndef SONJECT_KERNELS_MESH_RAY_H
#define SONJECT_KERNELS_MESH_RAY_H

#include "interval.h"
#include "mesh_records.h"

/* A ray in its own axes: the mesh's, turned in a circle until z is about the direction's largest
 * component. */
struct mesh_ray {
    struct vector3 point;    /* closest to the frame's origin */
    struct vector3 inverse;  /* one over the direction's components */
    vfloat shear_x, shear_y; /* the direction's x and y over its z */
    vfloat minimum;          /* distance from the point beyond which hits count */
    float padding;           /* padding of a triangle's own box, half of that of other boxes, m */
};

FUNCTION vfloat one_over_component(vfloat component)
{
    /* A ray along a box's face gets a slope by which it leaves 10^20 m away. */
    return 1.0f / SELECT(MASK_OF(magnitude(component) < 1.0e-20f), SPLAT(1.0e-20f), component);
}

FUNCTION struct vector3 one_over_components(struct vector3 direction)
{
    return vector3_of(one_over_component(direction.x), one_over_component(direction.y),
                      one_over_component(direction.z));
}

/* Returns the mesh's axis that is z of the ray's own axes: 0 x, 1 y, 2 z. The factors keep the
 * usual headings and grazing angles off the borders, so that the rays of a packet agree. */
FUNCTION vint own_z_of(struct vector3 direction)
{
    const vfloat x = magnitude(direction.x);
    const vfloat y = 0.83f * magnitude(direction.y);
    const vfloat z = 0.71f * magnitude(direction.z);
    const vint level = SELECT(MASK_OF(y > x), SPLAT_VINT(1), SPLAT_VINT(0));
    return SELECT(MASK_OF(z > larger(x, y)), SPLAT_VINT(2), level);
}

/* Finds the mesh's axes that are the ray's own x, y and z. */
FUNCTION void find_own_axes(int own_z, int axes[3])
{
    axes[0] = own_z < 2 ? own_z + 1 : 0;
    axes[1] = own_z > 0 ? own_z - 1 : 2;
    axes[2] = own_z;
}

/* Returns a vector of the mesh's axes in each ray's own. */
FUNCTION struct vector3 in_own_axes(struct vector3 v, vint own_z)
{
    const mask is_x = MASK_OF(own_z == 0), is_y = MASK_OF(own_z == 1);
    return vector3_of(SELECT(is_x, v.y, SELECT(is_y, v.z, v.x)),
                      SELECT(is_x, v.z, SELECT(is_y, v.x, v.y)),
                      SELECT(is_x, v.x, SELECT(is_y, v.y, v.z)));
}

FUNCTION struct mesh_ray mesh_ray_of(struct vector3 point, struct vector3 direction, vint own_z,
                                     vfloat minimum, float padding)
{
    struct mesh_ray ray;
    const struct vector3 own = in_own_axes(direction, own_z);
    ray.point = in_own_axes(point, own_z);
    ray.inverse = one_over_components(own);
    ray.shear_x = own.x * ray.inverse.z;
    ray.shear_y = own.y * ray.inverse.z;
    ray.minimum = minimum;
    ray.padding = padding;
    return ray;
}

/* Returns whether the ray meets the box between its minimum and `maximum`. Sets *entry to the
 * distance at which it enters the box. first, last: the faces that it meets first and last along
 * each axis. */
FUNCTION mask meets_box(const struct mesh_ray *ray, struct vector3 first, struct vector3 last,
                        vfloat maximum, vfloat *entry)
{
    const vfloat x_first = (first.x - ray->point.x) * ray->inverse.x;
    const vfloat y_first = (first.y - ray->point.y) * ray->inverse.y;
    const vfloat z_first = (first.z - ray->point.z) * ray->inverse.z;
    const vfloat x_last = (last.x - ray->point.x) * ray->inverse.x;
    const vfloat y_last = (last.y - ray->point.y) * ray->inverse.y;
    const vfloat z_last = (last.z - ray->point.z) * ray->inverse.z;
    const vfloat exit = smaller(smaller(x_last, y_last), smaller(z_last, maximum));
    *entry = larger(larger(x_first, y_first), larger(z_first, ray->minimum));
    return MASK_OF(*entry <= exit);
}

/* Returns where the ray's line is inside a box, whichever faces are met first. */
FUNCTION struct interval interval_in_box(const struct mesh_ray *ray, struct vector3 lower,
                                         struct vector3 upper)
{
    const vfloat x_lower = (lower.x - ray->point.x) * ray->inverse.x;
    const vfloat y_lower = (lower.y - ray->point.y) * ray->inverse.y;
    const vfloat z_lower = (lower.z - ray->point.z) * ray->inverse.z;
    const vfloat x_upper = (upper.x - ray->point.x) * ray->inverse.x;
    const vfloat y_upper = (upper.y - ray->point.y) * ray->inverse.y;
    const vfloat z_upper = (upper.z - ray->point.z) * ray->inverse.z;
    struct interval inside;
    inside.entry = larger(larger(smaller(x_lower, x_upper), smaller(y_lower, y_upper)),
                          smaller(z_lower, z_upper));
    inside.exit = smaller(smaller(larger(x_lower, x_upper), larger(y_lower, y_upper)),
                          larger(z_lower, z_upper));
    return inside;
}

/* The rows of faces that rays meet first and last along each of their axes. */
struct face_rows {
    int first[3], last[3];
};

/* axes: those of the boxes that are the rays' own. down_x, down_y, down_z: whether the rays run
 * down their own axes. */
FUNCTION struct face_rows face_rows_of(const int axes[3], int down_x, int down_y, int down_z)
{
    struct face_rows rows;
    rows.first[0] = down_x ? axes[0] + 3 : axes[0];
    rows.first[1] = down_y ? axes[1] + 3 : axes[1];
    rows.first[2] = down_z ? axes[2] + 3 : axes[2];
    rows.last[0] = down_x ? axes[0] : axes[0] + 3;
    rows.last[1] = down_y ? axes[1] : axes[1] + 3;
    rows.last[2] = down_z ? axes[2] : axes[2] + 3;
    return rows;
}

/* Loads a face of several boxes along each axis, from the box `slot` on. faces: rows of `slots`. */
FUNCTION struct vector3 load_faces(GLOBAL const float *faces, int slots, const int rows[3],
                                   int slot)
{
    return load_vector3(faces + rows[0] * slots, faces + rows[1] * slots, faces + rows[2] * slots,
                        slot);
}

/* Bounds over rays that run the same way along each axis, equal in every lane. A box that the
 * bounds miss is missed by every ray: the bounds come from the rays' own numbers by the operations
 * of the exact test, and rounding is monotonic. */
struct ray_bounds {
    struct vector3 to_first, to_last; /* the point nearest to a box's first faces and the one
                                         farthest from its last faces, along each axis */
    struct vector3 least, most;       /* bounds of the inverse directions */
    vfloat minimum;
    struct face_rows rows;
};

/* Returns the boxes that some of the rays may meet before `reach`: bit i is box i of `slots`. */
FUNCTION RECORD_WORD boxes_met(const struct ray_bounds *rays, GLOBAL const float *faces, int slots,
                               vfloat reach)
{
    const struct vector3 least = rays->least, most = rays->most;
    RECORD_WORD met = 0;
    for (int slot = 0; slot < slots; slot += WIDTH) {
        const struct vector3 first = load_faces(faces, slots, rays->rows.first, slot);
        const struct vector3 last = load_faces(faces, slots, rays->rows.last, slot);
        const vfloat x_first = first.x - rays->to_first.x;
        const vfloat y_first = first.y - rays->to_first.y;
        const vfloat z_first = first.z - rays->to_first.z;
        const vfloat x_last = last.x - rays->to_last.x;
        const vfloat y_last = last.y - rays->to_last.y;
        const vfloat z_last = last.z - rays->to_last.z;
        const vfloat entry =
            larger(larger(smaller(x_first * least.x, x_first * most.x),
                          smaller(y_first * least.y, y_first * most.y)),
                   larger(smaller(z_first * least.z, z_first * most.z), rays->minimum));
        const vfloat exit = smaller(smaller(larger(x_last * least.x, x_last * most.x),
                                            larger(y_last * least.y, y_last * most.y)),
                                    smaller(larger(z_last * least.z, z_last * most.z), reach));
        met |= lane_bits(MASK_OF(entry <= exit)) << slot;
    }
    return met;
}

struct mesh_corners {
    struct vector3 a, b, c;
};

/* Returns a point, in the ray's own axes, as seen along the ray: sheared so that the ray runs along
 * z from 0. */
FUNCTION struct vector3 seen_along(const struct mesh_ray *ray, struct vector3 point)
{
    const vfloat z = point.z - ray->point.z;
    return vector3_of((point.x - ray->point.x) - ray->shear_x * z,
                      (point.y - ray->point.y) - ray->shear_y * z, z);
}

/* Returns the functions of the edges opposite to a, b and c, for corners as seen along the ray.
 * Divided by their sum they are the corners' shares of the hit. */
FUNCTION struct vector3 edge_functions(const struct mesh_corners *seen)
{
    return vector3_of(seen->c.x * seen->b.y - seen->c.y * seen->b.x,
                      seen->a.x * seen->c.y - seen->a.y * seen->c.x,
                      seen->b.x * seen->a.y - seen->b.y * seen->a.x);
}

/* Returns where the ray's line is inside the triangle's own box, padded. */
FUNCTION struct interval corners_interval(const struct mesh_ray *ray,
                                          const struct mesh_corners *corners)
{
    const struct vector3 a = corners->a, b = corners->b, c = corners->c;
    struct vector3 lower, upper;
    lower = vector3_of(smaller(smaller(a.x, b.x), c.x) - ray->padding,
                       smaller(smaller(a.y, b.y), c.y) - ray->padding,
                       smaller(smaller(a.z, b.z), c.z) - ray->padding);
    upper = vector3_of(larger(larger(a.x, b.x), c.x) + ray->padding,
                       larger(larger(a.y, b.y), c.y) + ray->padding,
                       larger(larger(a.z, b.z), c.z) + ray->padding);
    return interval_in_box(ray, lower, upper);
}

/* Finds the distance from the ray's point to the triangle, in *distance where the mask is set.
 * corners: in the ray's own axes. Both sides are met.
 *
 * No ray slips between triangles that share an edge. A corner as seen along the ray depends on
 * these two alone, so neighbours agree on it to the bit. An edge's function is the difference of
 * two rounded products. Rounding is monotonic, so its sign is right, or the function is 0 and
 * counts as inside (Woop, Benthin and Wald 2013, without their second look in double). If all three
 * functions are 0, the triangle is seen edge-on, and its neighbours are met.
 *
 * The hit lies inside the triangle's own box. Nearly edge-on, functions that are rounding alone
 * could put it elsewhere, and then the order of a walk would decide whether it is found. */
FUNCTION mask meets_triangle(const struct mesh_ray *ray, const struct mesh_corners *corners,
                             vfloat *distance)
{
    struct mesh_corners seen;
    seen.a = seen_along(ray, corners->a);
    seen.b = seen_along(ray, corners->b);
    seen.c = seen_along(ray, corners->c);
    const struct vector3 edges = edge_functions(&seen);
    const vfloat least = smaller(smaller(edges.x, edges.y), edges.z);
    const vfloat most = larger(larger(edges.x, edges.y), edges.z);
    const vfloat sum = edges.x + edges.y + edges.z;
    const mask is_met = (MASK_OF(least >= 0.0f) | MASK_OF(most <= 0.0f)) & MASK_OF(sum != 0.0f);
    *distance = SPLAT(FAR_AWAY);
    if (!ANY(is_met))
        return is_met;
    const vfloat depth = (edges.x * seen.a.z + edges.y * seen.b.z + edges.z * seen.c.z) /
                         SELECT(is_met, sum, SPLAT(1.0f));
    const vfloat middle = depth * ray->inverse.z;
    const struct interval inside = corners_interval(ray, corners);
    *distance = smaller(larger(middle, inside.entry), inside.exit);
    return is_met & MASK_OF(inside.entry <= inside.exit);
}

#endif
