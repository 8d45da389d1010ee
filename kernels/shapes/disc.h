/* A disc in the x-y plane of its own frame, of the given radius. Both sides reflect, with the
 * plane's normal. */
#ifndef SONJECT_KERNELS_SHAPES_DISC_H
#define SONJECT_KERNELS_SHAPES_DISC_H

#include "shapes/plane.h"

FUNCTION struct spans disc_spans(GLOBAL const struct object_record *object, struct vector3 point,
                                 struct vector3 direction)
{
    const mask is_parallel = MASK_OF(magnitude(direction.z) < 1.0e-12f);
    const vfloat distance = -point.z / SELECT(is_parallel, SPLAT(1.0f), direction.z);
    const struct vector3 hit = along3(point, direction, distance);
    const mask is_hit =
        ~is_parallel & MASK_OF(hit.x * hit.x + hit.y * hit.y <= object->radius * object->radius);
    return spans_of_one(interval_where(is_hit, distance, distance));
}

FUNCTION struct vector3 disc_normal(GLOBAL const struct object_record *object, struct vector3 point,
                                    struct vector3 direction)
{
    return plane_normal(object, point, direction);
}

#endif
