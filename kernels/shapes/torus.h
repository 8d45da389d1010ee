/* A torus about the z axis of its own frame: a circle of ring_radius that goes round at `radius`.
 *
 * Along a ray, F = (rho - R)^2 + z^2 - b^2 is negative inside, with rho the distance from the axis,
 * R = radius and b = ring_radius. rho is convex, so F'' = 2 - 2 R rho'' changes sign at most twice,
 * at known places. F is concave between them and convex outside. So F falls to a valley, rises to a
 * crest, falls to a second valley and rises. Each stretch has at most one crossing, which a guarded
 * Newton iteration finds. A quartic's coefficients would cancel in single precision. */
#ifndef SONJECT_KERNELS_SHAPES_TORUS_H
#define SONJECT_KERNELS_SHAPES_TORUS_H

#include "elementary.h"
#include "interval.h"
#include "layout.h"

struct torus_ray {
    struct vector3 point, direction;
    float radius, ring_radius;
    vfloat across;  /* square of the direction's component across the axis */
    vfloat curving; /* rho'' rho^3: across times the squared least distance from the axis */
};

FUNCTION vfloat distance_from_axis(struct vector3 p)
{
    return larger(SQUARE_ROOT(p.x * p.x + p.y * p.y), SPLAT(1.0e-12f));
}

/* Computes F/2 and its slope. */
FUNCTION void torus_depth(const struct torus_ray *ray, vfloat distance, vfloat *value,
                          vfloat *slope)
{
    const struct vector3 p = along3(ray->point, ray->direction, distance);
    const vfloat rho = distance_from_axis(p);
    const vfloat outward = rho - ray->radius;
    const vfloat rho_slope = (p.x * ray->direction.x + p.y * ray->direction.y) / rho;
    *value = 0.5f * ((outward - ray->ring_radius) * (outward + ray->ring_radius) + p.z * p.z);
    *slope = outward * rho_slope + p.z * ray->direction.z;
}

/* Computes the slope of F/2 and the slope of that slope. */
FUNCTION void torus_slope(const struct torus_ray *ray, vfloat distance, vfloat *slope, vfloat *bend)
{
    const struct vector3 p = along3(ray->point, ray->direction, distance);
    const vfloat rho = distance_from_axis(p);
    const vfloat rho_slope = (p.x * ray->direction.x + p.y * ray->direction.y) / rho;
    const vfloat square = ray->across + ray->direction.z * ray->direction.z;
    *slope = (rho - ray->radius) * rho_slope + p.z * ray->direction.z;
    *bend = square - ray->radius * (ray->curving / (rho * rho * rho));
}

/* Returns where F/2, or with is_slope its slope, times `sense` falls through 0 in lower...upper.
 * Without a change of sign the result is lower or upper. A Newton step is taken if it stays between
 * the bounds and is at most half the step before, else the middle. A lane that has arrived rests,
 * so that no lane depends on others. */
FUNCTION vfloat torus_crossing(const struct torus_ray *ray, int is_slope, vfloat sense,
                               vfloat lower, vfloat upper, vfloat tolerance)
{
    vfloat distance = 0.5f * (lower + upper);
    vfloat last_step = upper - lower;
    mask is_going = MASK_OF(last_step > tolerance);
    for (int i = 0; i < 48 && ANY(is_going); i++) {
        vfloat value, slope;
        if (is_slope)
            torus_slope(ray, distance, &value, &slope);
        else
            torus_depth(ray, distance, &value, &slope);
        const mask is_before = MASK_OF(value * sense > 0.0f);
        lower = SELECT(is_going & is_before, distance, lower);
        upper = SELECT(is_going & ~is_before, distance, upper);
        const vfloat safe = SELECT(MASK_OF(magnitude(slope) < 1.0e-20f), SPLAT(1.0e-20f), slope);
        const vfloat step = -value / safe;
        const vfloat reached = distance + step;
        const mask is_good = MASK_OF(reached >= lower) & MASK_OF(reached <= upper) &
                             MASK_OF(magnitude(step) <= 0.5f * last_step);
        const vfloat middle = 0.5f * (lower + upper);
        const vfloat next = SELECT(is_good, reached, middle);
        const vfloat moved = magnitude(next - distance);
        last_step = SELECT(is_going, SELECT(is_good, moved, upper - lower), last_step);
        distance = SELECT(is_going, next, distance);
        is_going = is_going & MASK_OF(last_step > tolerance);
    }
    return distance;
}

/* The places where F's slope may turn: first valley, crest and second valley along a ray. */
struct torus_order {
    vfloat first, one, crest, other, last; /* distances, never falling */
    mask is_near;                          /* the ray comes near the torus at all */
};

FUNCTION struct torus_order torus_order_along(struct torus_ray *ray)
{
    const struct vector3 d = ray->direction;
    const float size = ray->radius + ray->ring_radius;
    const vfloat middle = -dot3(ray->point, d);
    const struct vector3 closest = along3(ray->point, d, middle);
    const vfloat square = size * size - dot3(closest, closest);
    const vfloat reach = SQUARE_ROOT(larger(square, SPLAT(0.0f)));
    const struct interval slab = interval_of_slab(ray->point.z, d.z, ray->ring_radius);
    struct torus_order order;
    order.first = larger(middle - reach, slab.entry);
    order.last = smaller(middle + reach, slab.exit);
    order.is_near = MASK_OF(square > 0.0f) & MASK_OF(order.first < order.last);
    order.last = larger(order.first, order.last);
    ray->across = d.x * d.x + d.y * d.y;
    const mask is_parallel = MASK_OF(ray->across < 1.0e-14f);
    const vfloat safe = SELECT(is_parallel, SPLAT(1.0e-14f), ray->across);
    const vfloat axis_at =
        SELECT(is_parallel, SPLAT(0.0f), -(ray->point.x * d.x + ray->point.y * d.y) / safe);
    const struct vector3 nearest = along3(ray->point, d, axis_at);
    const vfloat square_of_least = nearest.x * nearest.x + nearest.y * nearest.y;
    ray->curving = ray->across * square_of_least;
    /* F'' = 0 where rho^3 = R * curving. */
    const vfloat turning = cube_root(larger(ray->radius * ray->curving, SPLAT(1.0e-30f)));
    const vfloat concave =
        SQUARE_ROOT(larger(turning * turning - square_of_least, SPLAT(0.0f)) / safe);
    const vfloat from = smaller(larger(axis_at - concave, order.first), order.last);
    const vfloat to = smaller(larger(axis_at + concave, order.first), order.last);
    const vfloat tolerance = SPLAT(1.0e-4f * ray->ring_radius);
    const vfloat rising = SPLAT(-1.0f);
    const vfloat falling = SPLAT(1.0f);
    order.one = torus_crossing(ray, 1, rising, order.first, from, tolerance);
    order.crest = torus_crossing(ray, 1, falling, from, to, tolerance);
    order.other = torus_crossing(ray, 1, rising, to, order.last, tolerance);
    return order;
}

FUNCTION struct spans torus_spans(GLOBAL const struct object_record *object, struct vector3 point,
                                  struct vector3 direction)
{
    struct torus_ray ray;
    ray.point = point;
    ray.direction = direction;
    ray.radius = object->radius;
    ray.ring_radius = object->ring_radius;
    const struct torus_order order = torus_order_along(&ray);
    vfloat at_one, at_crest, at_other, slope;
    torus_depth(&ray, order.one, &at_one, &slope);
    torus_depth(&ray, order.crest, &at_crest, &slope);
    torus_depth(&ray, order.other, &at_other, &slope);
    const mask in_one = order.is_near & MASK_OF(at_one < 0.0f);
    const mask in_other = order.is_near & MASK_OF(at_other < 0.0f);
    const mask is_parted = MASK_OF(at_crest > 0.0f);
    const vfloat tolerance = SPLAT(2.0e-7f * (object->radius + object->ring_radius));
    const vfloat falling = SPLAT(1.0f);
    const vfloat rising = SPLAT(-1.0f);
    struct spans spans = spans_of_one(interval_where(in_one, order.one, order.one));
    if (!ANY(in_one | in_other))
        return spans;
    const vfloat into_one = torus_crossing(&ray, 0, falling, order.first, order.one, tolerance);
    const vfloat out_of_one = torus_crossing(&ray, 0, rising, order.one, order.crest, tolerance);
    const vfloat into_other = torus_crossing(&ray, 0, falling, order.crest, order.other, tolerance);
    const vfloat out_of_other = torus_crossing(&ray, 0, rising, order.other, order.last, tolerance);
    const mask both = in_one & in_other;
    spans.first =
        interval_where(in_one, into_one, SELECT(both & ~is_parted, out_of_other, out_of_one));
    spans.second = interval_where(in_other & (is_parted | ~in_one), into_other, out_of_other);
    return spans;
}

FUNCTION struct vector3 torus_normal(GLOBAL const struct object_record *object,
                                     struct vector3 point, struct vector3 direction)
{
    (void)direction;
    const vfloat rho = distance_from_axis(point);
    const vfloat outward = (rho - object->radius) / rho;
    const struct vector3 normal = vector3_of(point.x * outward, point.y * outward, point.z);
    const vfloat length = SQUARE_ROOT(dot3(normal, normal));
    const vfloat safe = SELECT(MASK_OF(length > 0.0f), length, SPLAT(1.0f));
    return divided3(normal, safe);
}

#endif
