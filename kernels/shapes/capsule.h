/* A cylinder along the x axis of its own frame, with half spheres as ends. */
#ifndef SONJECT_KERNELS_SHAPES_CAPSULE_H
#define SONJECT_KERNELS_SHAPES_CAPSULE_H

#include "shapes/cylinder.h"
#include "shapes/sphere.h"

/* The half_length is that of the straight part, the radius that of the cylinder and both ends. */
FUNCTION struct interval capsule_interval(GLOBAL const struct object_record *object,
                                          struct vector3 point, struct vector3 direction)
{
    struct vector3 from_nose = point;
    struct vector3 from_tail = point;
    from_nose.x = point.x - object->half_length;
    from_tail.x = point.x + object->half_length;
    const struct interval ends = interval_union(sphere_interval(object, from_nose, direction),
                                                sphere_interval(object, from_tail, direction));
    return interval_union(ends, cylinder_interval(object, point, direction));
}

FUNCTION struct vector3 capsule_normal(GLOBAL const struct object_record *object,
                                       struct vector3 point, struct vector3 direction)
{
    struct vector3 from_axis = point;
    from_axis.x =
        point.x - smaller(larger(point.x, SPLAT(-object->half_length)), SPLAT(object->half_length));
    return sphere_normal(object, from_axis, direction);
}

#endif
