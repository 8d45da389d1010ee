/* An ellipsoid about the origin of its own frame. Its semi-axes along x, y and z are half_length,
 * half_width and half_height. */
#ifndef SONJECT_KERNELS_SHAPES_ELLIPSOID_H
#define SONJECT_KERNELS_SHAPES_ELLIPSOID_H

#include "interval.h"
#include "layout.h"

FUNCTION struct vector3 in_semi_axes(GLOBAL const struct object_record *object, struct vector3 v)
{
    return vector3_of(v.x / object->half_length, v.y / object->half_width,
                      v.z / object->half_height);
}

/* Scales the semi-axes to 1, which gives a unit sphere. Distances along the ray do not change. */
FUNCTION struct spans ellipsoid_spans(GLOBAL const struct object_record *object,
                                      struct vector3 point, struct vector3 direction)
{
    const struct vector3 start = in_semi_axes(object, point);
    const struct vector3 step = in_semi_axes(object, direction);
    const vfloat square_of_step = dot3(step, step);
    const vfloat middle = -dot3(start, step) / square_of_step;
    const struct vector3 closest = along3(start, step, middle);
    const vfloat square = 1.0f - dot3(closest, closest);
    const vfloat reach = SQUARE_ROOT(larger(square, SPLAT(0.0f)) / square_of_step);
    return spans_of_one(interval_where(MASK_OF(square > 0.0f), middle - reach, middle + reach));
}

FUNCTION struct vector3 ellipsoid_normal(GLOBAL const struct object_record *object,
                                         struct vector3 point, struct vector3 direction)
{
    (void)direction;
    /* The shortest semi-axis as a factor keeps all squares within single precision. */
    float shortest =
        object->half_length < object->half_width ? object->half_length : object->half_width;
    shortest = object->half_height < shortest ? object->half_height : shortest;
    const struct vector3 scaled = in_semi_axes(object, point);
    const struct vector3 normal = vector3_of(scaled.x * (shortest / object->half_length),
                                             scaled.y * (shortest / object->half_width),
                                             scaled.z * (shortest / object->half_height));
    const vfloat length = SQUARE_ROOT(dot3(normal, normal));
    const vfloat safe = SELECT(MASK_OF(length > 0.0f), length, SPLAT(1.0f));
    return divided3(normal, safe);
}

#endif
