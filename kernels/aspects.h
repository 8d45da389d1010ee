/* The aspects of a synthetic aperture: each ray goes out squinted from broadside, and lies so that
 * its echo from the seabed focuses in the ray's own strip (kernels/MATH.md, "Aspects"). */
#ifndef SONJECT_KERNELS_ASPECTS_H
#define SONJECT_KERNELS_ASPECTS_H

#include "fan.h"
#include "random.h"

/* A ray of a fan turned out of its strip's plane about an axis across the track: from abreast it
 * looks as it did, so ranges as the image has them stay. */
struct aspect_ray {
    struct vector3 start;     /* at distance 0 of the fan's ray */
    struct vector3 direction; /* unit */
    real sine, cosine;        /* of the angle off broadside; a distance along the fan's ray is
                                 cosine times that along this one */
    real weight;              /* of the aspect, 1 on the mean */
};

/* A device builds without them where a scene has broadside rays alone; plain C has them unless it
 * is told otherwise. */
#if defined(WITH_ASPECTS) || !(defined(__OPENCL_C_VERSION__) || defined(WITHOUT_ASPECTS))
#define HAS_ASPECTS 1
#else
#define HAS_ASPECTS 0
#endif

/* Whether the launch's rays have aspects of their own. */
FUNCTION int has_aspects(const struct fan_record *fan)
{
    return HAS_ASPECTS && fan->aspects.sine > 0.0f;
}

/* The share 0...1 of the aperture that a ray looks from: the lattice of the plastic number, even
 * over any few neighbours among rays and strips, each point moved within an eighth. */
FUNCTION real aspect_share(const struct fan_record *fan, RECORD_WORD track_strip, word ray,
                           real jitter)
{
    const RECORD_WORD shift = track_strip * 0x91E10DA5u + fan->seed_low * 0x9E3779B9u;
    const real share = uniform_from(ray * 0xC13FA9A9u + SPLAT_WORD(shift)) + 0.125f * jitter;
    return CHOOSE(MASK_OF(share >= 1.0f), share - 1.0f, share);
}

/* Energy weight of an aspect, `offset` of the aperture's width from its middle: the square of the
 * response's window. */
FUNCTION real aspect_weight(const struct fan_record *fan, real offset)
{
    if (fan->aspects.terms == 0)
        return SPLAT(1.0f);
    real sine, cosine;
    sine_cosine_of_cycles(offset, &sine, &cosine);
    /* cosines of multiples by Chebyshev's recursion */
    real before = SPLAT(1.0f);
    real now = cosine;
    real amplitude = SPLAT(1.0f);
    for (int term = 0; term < fan->aspects.terms; term++) {
        amplitude = amplitude + fan->aspects.weights[term] * now;
        const real next = 2.0f * cosine * now - before;
        before = now;
        now = next;
    }
    return amplitude * amplitude * fan->aspects.scale;
}

/* The ray of the fan itself where the launch has one aspect only. track_strip: the ray's strip,
 * counted over the whole track; jitter: uniform in 0...1. */
FUNCTION struct aspect_ray aspect_ray_of(const struct fan_record *fan, const struct fan_ray *ray,
                                         RECORD_WORD track_strip, word number, real jitter)
{
    struct aspect_ray squinted;
    squinted.start = ray->closest;
    squinted.direction = ray->direction;
    squinted.sine = SPLAT(0.0f);
    squinted.cosine = SPLAT(1.0f);
    squinted.weight = SPLAT(1.0f);
    if (!has_aspects(fan))
        return squinted;
    const real offset = aspect_share(fan, track_strip, number, jitter) - 0.5f;
    squinted.sine = 2.0f * fan->aspects.sine * offset;
    squinted.cosine = SQUARE_ROOT(1.0f - squinted.sine * squinted.sine);
    squinted.weight = aspect_weight(fan, offset);
    /* across its strip where it meets the mean seabed, or where the patch ends */
    const real anchor = smaller(plane_distance(fan, ray->closest, ray->direction),
                                fan->aspects.end - ray->range_at_closest);
    squinted.start.x = ray->closest.x - anchor * (squinted.sine / squinted.cosine);
    squinted.direction.x = squinted.sine;
    squinted.direction.y = ray->direction.y * squinted.cosine;
    squinted.direction.z = ray->direction.z * squinted.cosine;
    return squinted;
}

/* The strip of the whole track that a position along it lies in. */
FUNCTION whole track_strip_at(const struct fan_record *fan, real x)
{
    const real coordinate = (x - fan->first_strip_x) / fan->strip_width + 0.5f;
    const real limited = smaller(larger(coordinate, SPLAT(-8.0e6f)), SPLAT(8.0e6f));
    const whole truncated = WHOLE_OF(limited);
    return truncated + MASK_OF(limited < REAL_OF(truncated)); /* a mask counts -1 */
}

#endif
