/* Cylinder along the x axis of its own frame with half spheres as ends. */
#ifndef SONJECT_KERNELS_SHAPES_CAPSULE_H
#define SONJECT_KERNELS_SHAPES_CAPSULE_H

#include "shapes/cylinder.h"
#include "shapes/sphere.h"

/* half_length: of the straight part. */
FUNCTION struct interval capsule_interval(struct vector3 point, struct vector3 direction,
                                          float half_length, float radius)
{
    struct vector3 from_nose = point;
    struct vector3 from_tail = point;
    from_nose.x = point.x - half_length;
    from_tail.x = point.x + half_length;
    const struct interval ends = interval_union(sphere_interval(from_nose, direction, radius),
                                                sphere_interval(from_tail, direction, radius));
    return interval_union(ends, cylinder_interval(point, direction, half_length, radius));
}

FUNCTION struct vector3 capsule_normal(struct vector3 point, float half_length, float radius)
{
    struct vector3 from_axis = point;
    from_axis.x = point.x - smaller(larger(point.x, SPLAT(-half_length)), SPLAT(half_length));
    return sphere_normal(from_axis, radius);
}

#endif
