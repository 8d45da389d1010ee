/* Rectangle in the x-y plane of its own frame; both sides reflect. */
#ifndef SONJECT_KERNELS_SHAPES_PLANE_H
#define SONJECT_KERNELS_SHAPES_PLANE_H

#include "interval.h"

FUNCTION struct interval plane_interval(struct vector3 point, struct vector3 direction,
                                        float half_length, float half_width)
{
    const mask is_parallel = MASK_OF(magnitude(direction.z) < 1.0e-12f);
    const vfloat distance = -point.z / SELECT(is_parallel, SPLAT(1.0f), direction.z);
    const struct vector3 hit = along3(point, direction, distance);
    const mask is_hit = ~is_parallel & MASK_OF(magnitude(hit.x) <= half_length) &
                        MASK_OF(magnitude(hit.y) <= half_width);
    return interval_where(is_hit, distance, distance);
}

/* On the side that the ray comes from. */
FUNCTION struct vector3 plane_normal(struct vector3 direction)
{
    struct vector3 normal;
    normal.x = SPLAT(0.0f);
    normal.y = SPLAT(0.0f);
    normal.z = SELECT(MASK_OF(direction.z > 0.0f), SPLAT(-1.0f), SPLAT(1.0f));
    return normal;
}

#endif
