/* A sphere about the origin of its own frame, of the given radius. */
#ifndef SONJECT_KERNELS_SHAPES_SPHERE_H
#define SONJECT_KERNELS_SHAPES_SPHERE_H

#include "interval.h"
#include "layout.h"

/* point: a point of the ray near the centre; direction: unit. */
FUNCTION struct interval sphere_interval(GLOBAL const struct object_record *object,
                                         struct vector3 point, struct vector3 direction)
{
    const vfloat middle = -dot3(point, direction);
    const struct vector3 closest = along3(point, direction, middle);
    const vfloat square = object->radius * object->radius - dot3(closest, closest);
    const vfloat reach = SQUARE_ROOT(larger(square, SPLAT(0.0f)));
    return interval_where(MASK_OF(square > 0.0f), middle - reach, middle + reach);
}

FUNCTION struct vector3 sphere_normal(GLOBAL const struct object_record *object,
                                      struct vector3 point, struct vector3 direction)
{
    (void)direction;
    return divided3(point, SPLAT(object->radius));
}

#endif
