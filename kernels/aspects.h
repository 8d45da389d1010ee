/* The aspects of a synthetic aperture. Each ray goes out squinted from broadside, and lies so that
 * its echo from the seabed focuses in the ray's own strip (kernels/MATH.md, "Aspects"). */
#ifndef SONJECT_KERNELS_ASPECTS_H
#define SONJECT_KERNELS_ASPECTS_H

#include "fan.h"
#include "random.h"

/* A ray of a fan, turned out of its strip's plane about an axis across the track. Seen from
 * broadside it looks unchanged, so ranges stay as the image has them. */
struct aspect_ray {
    struct vector3 start;     /* place at distance 0 of the fan's ray */
    struct vector3 direction; /* unit */
    vfloat sine, cosine; /* angle off broadside; a distance along the fan's ray is the cosine times
                            that along this one */
    vfloat weight;       /* weight of the aspect, 1 on average; within a beam see beam_ray_of */
};

/* Returns whether the launch's rays have aspects of a synthetic aperture. */
FUNCTION int has_aspects(const struct fan_record *fan)
{
    return fan->aspects.sine > 0.0f;
}

/* Returns whether the launch's rays go out within the beam of a real aperture. */
FUNCTION int has_beam(const struct fan_record *fan)
{
    return fan->beam.reach > 0.0f;
}

/* Returns the share 0...1 of the aperture that a ray looks from: the lattice of the plastic number,
 * each point moved within an eighth. Shares are even over any few neighbouring rays and strips. */
FUNCTION vfloat aspect_share(const struct fan_record *fan, RECORD_WORD track_strip, word ray,
                             vfloat jitter)
{
    const RECORD_WORD shift = track_strip * LATTICE_OF_2_1 + fan->seed_low * 0x9E3779B9u;
    const vfloat share = lattice_uniform(ray, LATTICE_OF_2_0, shift) + 0.125f * jitter;
    return SELECT(MASK_OF(share >= 1.0f), share - 1.0f, share);
}

/* Returns the energy weight of an aspect: the square of the response's window. offset: from the
 * middle of the aperture, as a share of its width. */
FUNCTION vfloat aspect_weight(const struct fan_record *fan, vfloat offset)
{
    if (fan->aspects.terms == 0)
        return SPLAT(1.0f);
    vfloat sine, cosine;
    sine_cosine_of_cycles(offset, &sine, &cosine);
    /* Chebyshev's recursion gives the cosines of multiples. */
    vfloat before = SPLAT(1.0f);
    vfloat now = cosine;
    vfloat amplitude = SPLAT(1.0f);
    for (int term = 0; term < fan->aspects.terms; term++) {
        amplitude = amplitude + fan->aspects.weights[term] * now;
        const vfloat next = 2.0f * cosine * now - before;
        before = now;
        now = next;
    }
    return amplitude * amplitude * fan->aspects.scale;
}

/* Returns the two-way power pattern of one side of the array at a direction cosine along it: sinc^2
 * one way, squared for there and back. */
FUNCTION vfloat two_way_pattern(float wavelengths, vfloat cosine)
{
    const vfloat amplitude = sinc_of_cycles(0.5f * wavelengths * cosine);
    const vfloat one_way = amplitude * amplitude;
    return one_way * one_way;
}

#define STEEPEST_SINE 0.95f /* the largest sine off broadside of a beam's rays */

/* Returns a ray within the beam, from the middle of its ping. share: 0...1. The ray's weight is the
 * two-way pattern times the range of sines that the ray stands for. This range takes the place of a
 * strip's width over range. */
FUNCTION struct aspect_ray beam_ray_of(const struct fan_record *fan, const struct fan_ray *ray,
                                       vfloat share)
{
    const struct beam_record *beam = &fan->beam;
    struct aspect_ray squinted;
    /* The beam's middle is where the way is square to the array's long side. */
    const vfloat slope =
        -(ray->direction.y * beam->along[1] + ray->direction.z * beam->along[2]) / beam->along[0];
    const vfloat square = 1.0f + slope * slope;
    const vfloat middle = slope / SQUARE_ROOT(square);
    const vfloat reach = beam->reach / (beam->along[0] * square);
    /* A cubic puts most rays where the pattern is high. */
    const vfloat side = 2.0f * share - 1.0f;
    const vfloat sine = middle + reach * side * (0.3f + 0.7f * side * side);
    const vfloat range = 2.0f * reach * (0.3f + 2.1f * side * side);
    squinted.sine = smaller(larger(sine, SPLAT(-STEEPEST_SINE)), SPLAT(STEEPEST_SINE));
    const mask is_near = MASK_OF(squinted.sine == sine);
    squinted.cosine = SQUARE_ROOT(1.0f - squinted.sine * squinted.sine);
    squinted.direction = vector3_of(squinted.sine, ray->direction.y * squinted.cosine,
                                    ray->direction.z * squinted.cosine);
    squinted.start = ray->closest;
    squinted.start.x = ray->closest.x + (fan->reference_range + ray->range_at_closest) *
                                            (squinted.sine / squinted.cosine);
    const vfloat u = squinted.direction.x * beam->along[0] + squinted.direction.y * beam->along[1] +
                     squinted.direction.z * beam->along[2];
    const vfloat v = squinted.direction.x * beam->across[0] +
                     squinted.direction.y * beam->across[1] +
                     squinted.direction.z * beam->across[2];
    const vfloat pattern = two_way_pattern(beam->length, u) * two_way_pattern(beam->height, v);
    squinted.weight = SELECT(is_near, range * pattern, SPLAT(0.0f));
    return squinted;
}

/* Returns the fan's ray itself, at broadside. */
FUNCTION struct aspect_ray broadside_aspect(const struct fan_ray *ray)
{
    struct aspect_ray broadside;
    broadside.start = ray->closest;
    broadside.direction = ray->direction;
    broadside.sine = SPLAT(0.0f);
    broadside.cosine = SPLAT(1.0f);
    broadside.weight = SPLAT(1.0f);
    return broadside;
}

/* Returns the squinted ray, or the fan's ray itself if the launch has one aspect only. track_strip:
 * the ray's strip, counted over the whole track; jitter: uniform in 0...1. */
FUNCTION struct aspect_ray aspect_ray_of(const struct fan_record *fan, const struct fan_ray *ray,
                                         RECORD_WORD track_strip, word number, vfloat jitter)
{
    struct aspect_ray squinted = broadside_aspect(ray);
    if (!has_aspects(fan) && !has_beam(fan))
        return squinted;
    const vfloat share = aspect_share(fan, track_strip, number, jitter);
    if (has_beam(fan))
        return beam_ray_of(fan, ray, share);
    const vfloat offset = share - 0.5f;
    squinted.sine = 2.0f * fan->aspects.sine * offset;
    squinted.cosine = SQUARE_ROOT(1.0f - squinted.sine * squinted.sine);
    squinted.weight = aspect_weight(fan, offset);
    /* The ray crosses its strip where it meets the mean seabed, or where the patch ends. */
    const vfloat anchor = smaller(plane_distance(fan, ray->closest, ray->direction),
                                  fan->aspects.end - ray->range_at_closest);
    squinted.start.x = ray->closest.x - anchor * (squinted.sine / squinted.cosine);
    squinted.direction = vector3_of(squinted.sine, ray->direction.y * squinted.cosine,
                                    ray->direction.z * squinted.cosine);
    return squinted;
}

/* Returns the wavefront area of a beam's ray over that of a strip's ray: range^2 d(sine)
 * d(elevation), with the whole range. broadside_range: less the reference range. */
FUNCTION vfloat beam_spread(const struct fan_record *fan, const struct aspect_ray *squinted,
                            vfloat broadside_range)
{
    return (fan->reference_range + broadside_range) /
           (squinted->cosine * squinted->cosine * squinted->cosine * fan->strip_width);
}

/* Returns the whole range of a broadside range. Both are less the reference range. */
FUNCTION vfloat whole_range(const struct fan_record *fan, const struct aspect_ray *squinted,
                            vfloat broadside_range)
{
    const vfloat lack = squinted->sine * squinted->sine / (1.0f + squinted->cosine);
    return (broadside_range + fan->reference_range * lack) / squinted->cosine;
}

/* Returns the strip of the whole track that holds a position along it. */
FUNCTION vint track_strip_at(const struct fan_record *fan, vfloat x)
{
    const vfloat coordinate = (x - fan->first_strip_x) / fan->strip_width + 0.5f;
    const vfloat limited = smaller(larger(coordinate, SPLAT(-8.0e6f)), SPLAT(8.0e6f));
    const vint truncated = VINT_OF(limited);
    return truncated + MASK_OF(limited < VFLOAT_OF(truncated)); /* a mask counts -1 */
}

#endif
