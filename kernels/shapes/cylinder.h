/* A cylinder along the x axis of its own frame, with flat ends: half_length, radius. */
#ifndef SONJECT_KERNELS_SHAPES_CYLINDER_H
#define SONJECT_KERNELS_SHAPES_CYLINDER_H

#include "interval.h"
#include "layout.h"

/* Returns where a ray is inside the infinite cylinder about the x axis. The discriminant is formed
 * at the closest approach to the axis, where nothing cancels. */
FUNCTION struct interval tube_interval(struct vector3 point, struct vector3 direction, float radius)
{
    const vfloat across = direction.y * direction.y + direction.z * direction.z;
    const mask is_parallel = MASK_OF(across < 1.0e-14f);
    const vfloat safe = SELECT(is_parallel, SPLAT(1.0e-14f), across);
    /* a ray along the axis keeps its distance from it */
    const vfloat middle =
        SELECT(is_parallel, SPLAT(0.0f), -(point.y * direction.y + point.z * direction.z) / safe);
    const vfloat y = point.y + direction.y * middle;
    const vfloat z = point.z + direction.z * middle;
    const vfloat square = radius * radius - (y * y + z * z);
    const vfloat reach = SQUARE_ROOT(larger(square, SPLAT(0.0f)) / safe);
    return interval_where(MASK_OF(square > 0.0f), middle - reach, middle + reach);
}

FUNCTION struct interval cylinder_interval(GLOBAL const struct object_record *object,
                                           struct vector3 point, struct vector3 direction)
{
    return interval_overlap(tube_interval(point, direction, object->radius),
                            interval_of_slab(point.x, direction.x, object->half_length));
}

/* Returns the normal of the end if the point is nearer to an end than to the side. */
FUNCTION struct vector3 cylinder_normal(GLOBAL const struct object_record *object,
                                        struct vector3 point, struct vector3 direction)
{
    (void)direction;
    const vfloat from_axis = SQUARE_ROOT(point.y * point.y + point.z * point.z);
    const mask on_end =
        MASK_OF(object->half_length - magnitude(point.x) < object->radius - from_axis);
    const vfloat safe = SELECT(MASK_OF(from_axis > 0.0f), from_axis, SPLAT(1.0f));
    return choose3(on_end, vector3_of(sign_of(point.x), SPLAT(0.0f), SPLAT(0.0f)),
                   vector3_of(SPLAT(0.0f), point.y / safe, point.z / safe));
}

#endif
