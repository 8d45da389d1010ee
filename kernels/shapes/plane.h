/* A rectangle in the x-y plane of its own frame (half_length, half_width). Both sides reflect. */
#ifndef SONJECT_KERNELS_SHAPES_PLANE_H
#define SONJECT_KERNELS_SHAPES_PLANE_H

#include "interval.h"
#include "layout.h"

FUNCTION struct interval plane_interval(GLOBAL const struct object_record *object,
                                        struct vector3 point, struct vector3 direction)
{
    const mask is_parallel = MASK_OF(magnitude(direction.z) < 1.0e-12f);
    const vfloat distance = -point.z / SELECT(is_parallel, SPLAT(1.0f), direction.z);
    const struct vector3 hit = along3(point, direction, distance);
    const mask is_hit = ~is_parallel & MASK_OF(magnitude(hit.x) <= object->half_length) &
                        MASK_OF(magnitude(hit.y) <= object->half_width);
    return interval_where(is_hit, distance, distance);
}

/* Returns the normal on the side that the ray comes from. */
FUNCTION struct vector3 plane_normal(GLOBAL const struct object_record *object,
                                     struct vector3 point, struct vector3 direction)
{
    (void)object;
    (void)point;
    return vector3_of(SPLAT(0.0f), SPLAT(0.0f), sign_of(-direction.z));
}

#endif
