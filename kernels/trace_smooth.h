/* The coherent part at one interaction: physical optics on smooth surfaces. Each ray stands for a
 * cell of the wavefront, along-track stratum times elevation step; the phase is integrated over the
 * cell on the tangent plane and counted at its middle (kernels/MATH.md, "Smooth surfaces"). */
#ifndef SONJECT_KERNELS_TRACE_SMOOTH_H
#define SONJECT_KERNELS_TRACE_SMOOTH_H

#include "fan.h"
#include "intersection.h"
#include "random.h"
#include "surface.h"
#include "tally.h"

/* Echoes of one group of rays, lane by lane. */
struct smooth_echo {
    float real_part[WIDTH], imaginary_part[WIDTH]; /* quanta */
    float fraction[WIDTH];                         /* of a bin beyond `bin` */
    int bin[WIDTH];                                /* -1: no echo */
};

/* Range of the cell's middle (less the reference range) and the in-cell phase integral. */
struct cell_phase {
    real range;
    real integral;
};

/* The path's gradient over the cell is -2 n.q/(n.d) along q, the direction across the ray. */
FUNCTION struct cell_phase integrate_cell(const struct fan_record *fan, const struct fan_ray *ray,
                                          struct vector3 normal, real cosine, real range,
                                          real offset_along, real offset_across, real width_along,
                                          real width_across)
{
    const real gradient_along = 2.0f * normal.x / cosine;
    const real gradient_across = 2.0f * dot3(normal, ray->upward) / cosine;
    const float per_cycle =
        0.5f * fan->inverse_wavelength; /* k w g / 2 in cycles is w g / (2 lambda) */
    struct cell_phase phase;
    phase.range = range - 0.5f * (gradient_along * offset_along + gradient_across * offset_across);
    const real limit = SPLAT(4.0e6f);
    phase.integral =
        sinc_of_cycles(smaller(magnitude(per_cycle * width_along * gradient_along), limit)) *
        sinc_of_cycles(smaller(magnitude(per_cycle * width_across * gradient_across), limit));
    return phase;
}

FUNCTION void trace_smooth_group(const struct fan_record *fan,
                                 GLOBAL const struct object_record *objects, int strip, int stratum,
                                 struct random_key key, RECORD_WORD first_ray,
                                 struct smooth_echo *echo)
{
    const word number = SPLAT_WORD(first_ray) + LANE_NUMBERS;
    const mask is_ray = MASK_OF(number < fan->rays);
    real along, across;
    two_uniforms(key, number, (RECORD_WORD)stratum, &along, &across);
    const float width_along = fan->strip_width / (float)fan->strata;
    const real offset_along = (along - 0.5f) * width_along;
    const float middle = strip_position(fan, strip) +
                         ((float)stratum + 0.5f - 0.5f * (float)fan->strata) * width_along;
    const struct fan_ray ray =
        fan_ray_at(fan, middle + offset_along,
                   fan->first_elevation + (REAL_OF(number) + across) * fan->elevation_step);
    const struct nearest_hit nearest =
        find_nearest_hit(objects, fan->objects, ray.closest, ray.direction, -fan->reference_range);
    const mask is_hit =
        is_ray & MASK_OF(nearest.object == fan->only_object) &
        MASK_OF(nearest.distance < seabed_distance(fan, ray.closest, ray.direction));
    const real distance = CHOOSE(is_hit, nearest.distance, SPLAT(0.0f));
    const GLOBAL struct object_record *object = &objects[fan->only_object];
    const struct vector3 normal = object_normal(object, ray.closest, ray.direction, distance);
    const real cosine = larger(-dot3(normal, ray.direction), SPLAT(1.0e-6f));
    const real range = ray.range_at_closest + distance;
    const real width_across = fan->elevation_step * (fan->reference_range + range);
    const struct cell_phase phase =
        integrate_cell(fan, &ray, normal, cosine, range, offset_along,
                       (across - 0.5f) * width_across, SPLAT(width_along), width_across);
    const real amplitude =
        phase.integral * width_along * width_across * fan->inverse_wavelength * fan->quanta;
    real reflection_real, reflection_imaginary;
    smooth_reflection(&object->surface, cosine, &reflection_real, &reflection_imaginary);
    real sine_of_phase, cosine_of_phase;
    const real limited = smaller(larger(phase.range, SPLAT(-1.0e4f)), SPLAT(1.0e4f));
    sine_cosine_of_cycles(limited * fan->cycles_per_metre + fan->first_cycles, &sine_of_phase,
                          &cosine_of_phase);
    const real position = limited * fan->bins_per_metre + fan->first_bin;
    const mask is_counted =
        is_hit & MASK_OF(position >= 0.0f) & MASK_OF(position < (float)(fan->bins - 1));
    const real kept = CHOOSE(is_counted, position, SPLAT(0.0f));
    const whole bin = WHOLE_OF(kept);
    const real fraction = kept - REAL_OF(bin);
    const whole bin_or_none = CHOOSE(is_counted, bin, bin - bin - 1);
    /* times -i */
    const real real_part =
        amplitude * (reflection_real * sine_of_phase + reflection_imaginary * cosine_of_phase);
    const real imaginary_part =
        amplitude * (reflection_imaginary * sine_of_phase - reflection_real * cosine_of_phase);
    STORE_REAL(real_part, echo->real_part);
    STORE_REAL(imaginary_part, echo->imaginary_part);
    STORE_REAL(fraction, echo->fraction);
    STORE_WHOLE(bin_or_none, echo->bin);
}

/* Shares an echo between the two bins about it: linear in range, so that the pulse's envelope moves
 * by the exact delay (its error is that of linear interpolation between bins). */
FUNCTION void tally_smooth_echo(GLOBAL TALLY *tally, const struct smooth_echo *echo, int lane,
                                struct outcome_record *outcome)
{
    const int bin = echo->bin[lane];
    if (bin < 0)
        return;
    const float later = echo->fraction[lane];
    const float sooner = 1.0f - later;
    tally_add(&tally[2 * bin], echo->real_part[lane] * sooner, &outcome->faults);
    tally_add(&tally[2 * bin + 1], echo->imaginary_part[lane] * sooner, &outcome->faults);
    tally_add(&tally[2 * bin + 2], echo->real_part[lane] * later, &outcome->faults);
    tally_add(&tally[2 * bin + 3], echo->imaginary_part[lane] * later, &outcome->faults);
    outcome->impulses++;
}

/* Traces the share `segment` of a sub-strip's fan; tally: strips x bins x (real, imaginary). */
FUNCTION struct outcome_record trace_smooth_strip(const struct fan_record *fan,
                                                  GLOBAL const struct object_record *objects,
                                                  GLOBAL TALLY *tally, int strip, int segment)
{
    struct outcome_record outcome = {0, 0, 0, 0};
    const struct random_key key = random_key_of(fan->seed_low, fan->seed_high, fan->stream,
                                                (RECORD_WORD)(fan->first_strip + strip));
    GLOBAL TALLY *line = tally + (long)strip * fan->bins * 2;
    const RECORD_WORD groups = (fan->rays + WIDTH - 1u) / WIDTH;
    for (int stratum = 0; stratum < (int)fan->strata; stratum++)
        for (RECORD_WORD group = (RECORD_WORD)segment; group < groups;
             group += (RECORD_WORD)fan->segments) {
            struct smooth_echo echo;
            const RECORD_WORD left = fan->rays - group * WIDTH;
            outcome.rays += left < WIDTH ? left : WIDTH;
            trace_smooth_group(fan, objects, strip, stratum, key, group * WIDTH, &echo);
            for (int lane = 0; lane < WIDTH; lane++)
                tally_smooth_echo(line, &echo, lane, &outcome);
        }
    outcome.queries += outcome.rays;
    return outcome;
}

#endif
