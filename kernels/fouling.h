/* The fouling of objects: random fields of albedo and of relief over their surface
 * (kernels/MATH.md, "Fouling"). */
#ifndef SONJECT_KERNELS_FOULING_H
#define SONJECT_KERNELS_FOULING_H

#include "elementary.h"
#include "vector3.h"

/* The largest gain of a facet that turns to the sound: beyond, facets would shade each other. */
#define FACET_BRIGHTEST 4.0f

/* Returns cos(2 pi cycles) for |cycles| < 2^22. The error is below 5e-5, which no random field
 * shows, in half the time of sine_cosine_of_cycles. */
FUNCTION vfloat cosine_nearly(vfloat cycles)
{
    const vfloat turns = cycles - nearest_integer(cycles);
    const vfloat square = turns * turns;
    return 0.99995982f +
           square * (-19.7310429f +
                     square * (64.6734488f + square * (-82.4036447f + square * 45.6467247f)));
}

FUNCTION vfloat wave_at(GLOBAL const struct fouling_wave *wave, struct vector3 point)
{
    return cosine_nearly((wave->x * point.x + wave->y * point.y) +
                         (wave->z * point.z + wave->phase));
}

/* Returns the albedo over the material's. point: from the centre, in the axes of the frame. */
FUNCTION vfloat albedo_at(GLOBAL const struct fouling_record *fouling, struct vector3 point)
{
    vfloat sum = SPLAT((float)-FOULING_WAVES);
    for (int i = 0; i < FOULING_WAVES; i++)
        sum += wave_at(&fouling->albedo[i], point);
    return fouling->albedo_peak *
           exponential_of_negative(smaller(sum * fouling->albedo_gain, SPLAT(0.0f)));
}

/* Returns a normal to the relief's facet, with the length 1 along the surface's own normal. */
FUNCTION struct vector3 facet_at(GLOBAL const struct fouling_record *fouling, struct vector3 point,
                                 struct vector3 normal)
{
    struct vector3 slope = {SPLAT(0.0f), SPLAT(0.0f), SPLAT(0.0f)};
    for (int i = 0; i < FOULING_WAVES; i++) {
        GLOBAL const struct fouling_wave *wave = &fouling->relief[i];
        const vfloat rise = fouling->slope_gain * wave_at(wave, point);
        slope.x += rise * wave->x;
        slope.y += rise * wave->y;
        slope.z += rise * wave->z;
    }
    return along3(along3(normal, normal, dot3(slope, normal)), slope, SPLAT(-1.0f));
}

/* Returns the factor of fouling on scattering at a point of the object, between two directions
 * above its surface: the albedo, times the gain of a facet that turns to the middle of both. */
FUNCTION vfloat fouling_factor(GLOBAL const struct object_record *object, struct vector3 point,
                               struct vector3 normal, struct vector3 one, struct vector3 other)
{
    vfloat factor = SPLAT(1.0f);
    if (!HAS_FOULING || object->fouling_words == 0)
        return factor;
    GLOBAL const struct fouling_record *fouling =
        (GLOBAL const struct fouling_record *)((GLOBAL const RECORD_WORD *)object +
                                               object->fouling_words);
    point = vector3_of(point.x - object->centre_x, point.y - object->centre_y,
                       point.z - object->centre_z);
    if (fouling->slope_gain > 0.0f) {
        const struct vector3 sum = along3(one, other, SPLAT(1.0f));
        factor =
            dot3(facet_at(fouling, point, normal), sum) / larger(dot3(normal, sum), SPLAT(1.0e-6f));
        factor = smaller(larger(factor, SPLAT(0.0f)), SPLAT(FACET_BRIGHTEST));
    }
    if (fouling->albedo_gain > 0.0f)
        factor = factor * albedo_at(fouling, point);
    return factor;
}

#endif
