/* The seabed that rays meet: the mean plane, or a relief over it. */
#ifndef SONJECT_KERNELS_SEABED_H
#define SONJECT_KERNELS_SEABED_H

#include "fan.h"
#if HAS_RELIEF
#include "relief.h"
#endif

FUNCTION int has_relief(const struct fan_record *fan)
{
#if HAS_RELIEF
    return fan->relief_words != 0;
#else
    (void)fan;
    return 0;
#endif
}

/* Distance to the seabed beyond `minimum` (a plane has but one), FAR_AWAY if there is none; for
 * lanes that are not wanted, to the plane. */
FUNCTION vfloat seabed_distance(const struct fan_record *fan,
                                GLOBAL const struct object_record *objects, struct vector3 point,
                                struct vector3 direction, vfloat minimum, mask is_wanted)
{
    const vfloat to_plane = plane_distance(fan, point, direction);
#if HAS_RELIEF
    if (has_relief(fan))
        return relief_distance(fan, objects, point, direction, minimum, to_plane, is_wanted);
#endif
    (void)objects;
    (void)minimum;
    (void)is_wanted;
    return to_plane;
}

/* Upward unit normal where rays have met the seabed. */
FUNCTION struct vector3 seabed_normal(const struct fan_record *fan,
                                      GLOBAL const struct object_record *objects,
                                      struct vector3 point, struct vector3 direction)
{
#if HAS_RELIEF
    if (has_relief(fan))
        return relief_normal(fan, objects, point, direction);
#endif
    (void)fan;
    (void)objects;
    (void)point;
    (void)direction;
    struct vector3 up;
    up.x = SPLAT(0.0f);
    up.y = SPLAT(0.0f);
    up.z = SPLAT(1.0f);
    return up;
}

/* Whether no relief is between two points. Over the plane nothing is: both are above it. */
FUNCTION mask is_clear_of_relief(const struct fan_record *fan,
                                 GLOBAL const struct object_record *objects, struct vector3 point,
                                 struct vector3 direction, vfloat length, mask is_wanted)
{
    if (!has_relief(fan))
        return is_wanted;
    return is_wanted & MASK_OF(seabed_distance(fan, objects, point, direction, SPLAT(0.0f),
                                               is_wanted) > length);
}

#endif
