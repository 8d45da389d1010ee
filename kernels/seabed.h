/* The seabed that rays meet: the mean plane, or a relief over it. */
#ifndef SONJECT_KERNELS_SEABED_H
#define SONJECT_KERNELS_SEABED_H

#include "fan.h"
#if HAS_RELIEF
#include "relief.h"
#endif

FUNCTION int has_relief(const struct trace *trace)
{
    return HAS_RELIEF && trace->fan.relief_words != 0;
}

/* Returns the distance to the seabed beyond `minimum`, FAR_AWAY if there is none. A plane is met
 * once, whatever the minimum. Lanes that are not wanted get the distance to the plane. */
FUNCTION vfloat seabed_distance(const struct trace *trace, struct vector3 point,
                                struct vector3 direction, vfloat minimum, mask is_wanted)
{
    const vfloat to_plane = plane_distance(&trace->fan, point, direction);
#if HAS_RELIEF
    if (has_relief(trace))
        return relief_distance(trace, point, direction, minimum, to_plane, is_wanted);
#endif
    (void)minimum;
    (void)is_wanted;
    return to_plane;
}

/* Returns the upward unit normal where rays have met the seabed. */
FUNCTION struct vector3 seabed_normal(const struct trace *trace, struct vector3 point,
                                      struct vector3 direction)
{
#if HAS_RELIEF
    if (has_relief(trace))
        return relief_normal(trace, point, direction);
#endif
    (void)trace;
    (void)point;
    (void)direction;
    return vector3_of(SPLAT(0.0f), SPLAT(0.0f), SPLAT(1.0f));
}

/* Returns where no relief lies between two points. Both points are above the mean plane. */
FUNCTION mask is_clear_of_relief(const struct trace *trace, struct vector3 point,
                                 struct vector3 direction, vfloat length, mask is_wanted)
{
    if (!has_relief(trace))
        return is_wanted;
    return is_wanted &
           MASK_OF(seabed_distance(trace, point, direction, SPLAT(0.0f), is_wanted) > length);
}

#endif
