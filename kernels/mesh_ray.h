/* Intersections of rays with one box and one triangle of a mesh. Ray and triangle both have a value
 * in each lane. A packet of rays against one triangle, and one ray against several, give the same
 * bits. */
#ifndef SONJECT_KERNELS_MESH_RAY_H
#define SONJECT_KERNELS_MESH_RAY_H

#include "interval.h"
#include "mesh_records.h"

struct mesh_ray {
    struct vector3 point;              /* closest to the frame's origin */
    struct vector3 direction, inverse; /* unit; one over its components */
    struct vector3 across, upward;     /* unit, square to direction */
    struct vector3 seen;               /* the point in the axes across, upward, direction */
    vfloat minimum;                    /* distance from the point beyond which hits count */
    float padding; /* padding of a triangle's own box, half of that of other boxes, m */
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

FUNCTION struct mesh_ray mesh_ray_of(struct vector3 point, struct vector3 direction, vfloat minimum,
                                     float padding)
{
    struct mesh_ray ray;
    ray.point = point;
    ray.direction = direction;
    ray.inverse = one_over_components(direction);
    tangents3(direction, &ray.across, &ray.upward);
    ray.seen = vector3_of(dot3(point, ray.across), dot3(point, ray.upward), dot3(point, direction));
    ray.minimum = minimum;
    ray.padding = padding;
    return ray;
}

/* Returns the distance at which the ray enters the box, FAR_AWAY if it does not do so between its
 * minimum and `maximum`. first, last: the faces that it meets first and last along each axis. */
FUNCTION vfloat entry_by_faces(const struct mesh_ray *ray, struct vector3 first,
                               struct vector3 last, vfloat maximum)
{
    const vfloat x_first = (first.x - ray->point.x) * ray->inverse.x;
    const vfloat y_first = (first.y - ray->point.y) * ray->inverse.y;
    const vfloat z_first = (first.z - ray->point.z) * ray->inverse.z;
    const vfloat x_last = (last.x - ray->point.x) * ray->inverse.x;
    const vfloat y_last = (last.y - ray->point.y) * ray->inverse.y;
    const vfloat z_last = (last.z - ray->point.z) * ray->inverse.z;
    const vfloat entry = larger(larger(x_first, y_first), larger(z_first, ray->minimum));
    const vfloat exit = smaller(smaller(x_last, y_last), smaller(z_last, maximum));
    return SELECT(MASK_OF(entry <= exit), entry, SPLAT(FAR_AWAY));
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

/* Returns the same bits as entry_by_faces. */
FUNCTION vfloat box_entry(const struct mesh_ray *ray, struct vector3 lower, struct vector3 upper,
                          vfloat maximum)
{
    const struct interval inside = interval_in_box(ray, lower, upper);
    const vfloat entry = larger(inside.entry, ray->minimum);
    return SELECT(MASK_OF(entry <= smaller(inside.exit, maximum)), entry, SPLAT(FAR_AWAY));
}

/* Bounds over rays that run the same way along each axis, equal in every lane. A box that the
 * bounds miss is missed by every ray: the bounds come from the rays' own numbers by the operations
 * of the exact test, and rounding is monotonic. */
struct ray_bounds {
    struct vector3 to_first, to_last; /* the point nearest to a box's first faces and the one
                                         farthest from its last faces, along each axis */
    struct vector3 least, most;       /* bounds of the inverse directions */
    vfloat minimum;
    int downward[3]; /* 0 or 1: the rays run down the axis */
};

/* Returns the boxes that some of the rays may meet before `reach`: bit i is box i of `slots`. */
FUNCTION RECORD_WORD boxes_met(const struct ray_bounds *rays, GLOBAL const float *lower_x,
                               GLOBAL const float *lower_y, GLOBAL const float *lower_z,
                               GLOBAL const float *upper_x, GLOBAL const float *upper_y,
                               GLOBAL const float *upper_z, int slots, vfloat reach)
{
    const int *down = rays->downward;
    const struct vector3 least = rays->least, most = rays->most;
    RECORD_WORD met = 0;
    for (int slot = 0; slot < slots; slot += WIDTH) {
        const struct vector3 first =
            load_vector3(down[0] ? upper_x : lower_x, down[1] ? upper_y : lower_y,
                         down[2] ? upper_z : lower_z, slot);
        const struct vector3 last =
            load_vector3(down[0] ? lower_x : upper_x, down[1] ? lower_y : upper_y,
                         down[2] ? lower_z : upper_z, slot);
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

/* Returns the children of a branch that some of the rays may meet before `reach`, as bits. */
#define CHILDREN_MET(rays, branch, slots, reach)                                                   \
    boxes_met(rays, (branch)->lower_x, (branch)->lower_y, (branch)->lower_z, (branch)->upper_x,    \
              (branch)->upper_y, (branch)->upper_z, slots, reach)

struct mesh_corners {
    struct vector3 a, b, c;
};

FUNCTION struct mesh_corners leaf_corners(GLOBAL const struct mesh_leaf *leaf, int first)
{
    struct mesh_corners corners;
    corners.a = load_vector3(leaf->a_x, leaf->a_y, leaf->a_z, first);
    corners.b = load_vector3(leaf->b_x, leaf->b_y, leaf->b_z, first);
    corners.c = load_vector3(leaf->c_x, leaf->c_y, leaf->c_z, first);
    return corners;
}

/* Returns a point as seen along the ray: across, upward and along it. */
FUNCTION struct vector3 seen_along(const struct mesh_ray *ray, struct vector3 point)
{
    return vector3_of(dot3(point, ray->across) - ray->seen.x,
                      dot3(point, ray->upward) - ray->seen.y,
                      dot3(point, ray->direction) - ray->seen.z);
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

/* Finds the distance from the ray's point to the triangle, in *distance where the mask is set. Both
 * sides are met.
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
    const vfloat middle = (edges.x * seen.a.z + edges.y * seen.b.z + edges.z * seen.c.z) /
                          SELECT(is_met, sum, SPLAT(1.0f));
    const struct interval inside = corners_interval(ray, corners);
    *distance = smaller(larger(middle, inside.entry), inside.exit);
    return is_met & MASK_OF(inside.entry <= inside.exit);
}

#endif
