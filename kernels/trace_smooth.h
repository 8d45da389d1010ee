/* The coherent part at one interaction: physical optics on smooth surfaces. Each ray stands for a
 * cell of the wavefront, along-track stratum times elevation step. The phase is integrated over the
 * cell on the tangent plane and counted at its middle (kernels/MATH.md, "Smooth surfaces"). */
#ifndef SONJECT_KERNELS_TRACE_SMOOTH_H
#define SONJECT_KERNELS_TRACE_SMOOTH_H

#include "fan.h"
#include "image_sources.h"
#include "intersection.h"
#include "random.h"
#include "seabed.h"
#include "slices.h"
#include "surface.h"
#include "tally.h"

/* The echoes of one group of rays, lane by lane. */
struct smooth_echo {
    float real_part[WIDTH], imaginary_part[WIDTH]; /* quanta */
    float fraction[WIDTH];                         /* share of a bin beyond `bin` */
    float dither[WIDTH];                           /* uniform deviate for rounding */
    int bin[WIDTH];                                /* -1: no echo */
};

/* A ray and its cell of the wavefront. */
struct wavefront_cell {
    struct fan_ray ray;
    vfloat elevation;
    mask is_ray;
    float width_along;                    /* m */
    vfloat offset_along, fraction_across; /* place of the hit: m off the middle; 0...1 */
    vfloat dither;                        /* uniform deviate for rounding the echo */
};

/* Returns the shift of a stratum's cells across the ray, -0.5...0.5 of their width, even over any
 * few neighbours. Without it the steps of cells along an edge would keep time with the echo's phase
 * from strip to strip, and the edge would shine. */
FUNCTION float cell_shift_of(const struct trace *trace, int stratum)
{
    const struct fan_record *fan = &trace->fan;
    const RECORD_WORD turn =
        (RECORD_WORD)(fan->track_strip + fan->first_strip + trace->strip) * fan->strata +
        (RECORD_WORD)stratum;
    return (float)((turn * 0x9E3779B9u) >> 9) * 1.1920928955078125e-7f - 0.5f;
}

/* Returns the cells of one group of rays. shift: of the cells across the ray, in their widths. */
FUNCTION struct wavefront_cell wavefront_cell_at(const struct trace *trace, int stratum,
                                                 float shift, RECORD_WORD first_ray)
{
    const struct fan_record *fan = &trace->fan;
    const word number = SPLAT_WORD(first_ray) + LANE_NUMBERS;
    struct wavefront_cell cell;
    vfloat along;
    three_uniforms(trace->key, number, (RECORD_WORD)stratum, &along, &cell.fraction_across,
                   &cell.dither);
    cell.is_ray = MASK_OF(number < fan->rays);
    cell.width_along = fan->strip_width / (float)fan->strata;
    cell.offset_along = (along - 0.5f) * cell.width_along;
    const float middle = strip_position(trace) +
                         ((float)stratum + 0.5f - 0.5f * (float)fan->strata) * cell.width_along;
    cell.elevation = fan->first_elevation +
                     (VFLOAT_OF(number) + cell.fraction_across + shift) * fan->elevation_step;
    cell.ray = fan_ray_at(trace, middle + cell.offset_along, cell.elevation);
    return cell;
}

/* A cell's echo before the integral across the ray (whole_cell). range: half the path by way of the
 * cell's middle, less the reference range; amplitude: over the reflection coefficient, quanta. */
struct cell_phase {
    vfloat range;
    vfloat amplitude;
    vfloat across; /* wavelengths by which half the path changes across the cell */
    vfloat dither; /* uniform deviate for rounding */
};

/* Integrates a cell's phase along the track. gradient: of the whole path, along-track and across
 * the ray; range: half the path by way of the hit; wavefront: width per rad of elevation there. */
FUNCTION struct cell_phase integrate_cell(const struct fan_record *fan,
                                          const struct wavefront_cell *cell, vfloat gradient_along,
                                          vfloat gradient_across, vfloat range, vfloat wavefront)
{
    const float width_along = cell->width_along;
    const vfloat width_across = fan->elevation_step * wavefront;
    const vfloat offset_across = (cell->fraction_across - 0.5f) * width_across;
    const float per_cycle =
        0.5f * fan->inverse_wavelength; /* k w g / 2 in cycles is w g / (2 lambda) */
    struct cell_phase phase;
    phase.dither = cell->dither;
    phase.range =
        range - 0.5f * (gradient_along * cell->offset_along + gradient_across * offset_across);
    const vfloat limit = SPLAT(4.0e6f);
    const vfloat integral =
        sinc_of_cycles(smaller(magnitude(per_cycle * width_along * gradient_along), limit));
    phase.across = larger(smaller(per_cycle * width_across * gradient_across, limit), -limit);
    phase.amplitude = integral * width_along * width_across * fan->inverse_wavelength * fan->quanta;
    return phase;
}

/* Returns the cell as one echo. A cell at an edge counts all or nothing, as its ray does, and at
 * its middle. An edge then returns on average sinc^2 of its echo, which is made up for where asked
 * (edge_across). */
FUNCTION struct cell_phase whole_cell(const struct fan_record *fan, struct cell_phase phase)
{
    const vfloat integral = sinc_of_cycles(magnitude(phase.across));
    phase.amplitude = phase.amplitude * SELECT(MASK_OF(magnitude(phase.across) < fan->edge_across),
                                               1.0f / integral, integral);
    return phase;
}

/* The most parts of a cell. Cells of a face seen so flat that the path changes by a wavelength from
 * one to the next would add up like a mirror's. A cell is therefore cut across the ray into parts
 * with a change of 0.8 wavelengths at most, if this many parts are enough. */
#define CELL_PARTS_MAX 8
FUNCTION vint parts_of_cell(struct cell_phase phase)
{
    return VINT_OF(1.0f + smaller(2.5f * magnitude(phase.across), SPLAT(CELL_PARTS_MAX - 1.0f)));
}

/* Returns one of `parts` parts of a cell, at its own middle. */
FUNCTION struct cell_phase part_of_cell(const struct fan_record *fan, struct cell_phase phase,
                                        int part, vint parts)
{
    const vfloat share = 1.0f / VFLOAT_OF(parts);
    const vfloat off_middle = (float)part - 0.5f * (VFLOAT_OF(parts) - 1.0f);
    phase.across = phase.across * share;
    phase.range = phase.range + off_middle * phase.across / fan->inverse_wavelength;
    phase.amplitude = phase.amplitude * share;
    return whole_cell(fan, phase);
}

/* Puts -i times amplitude times reflection at the phase and in the bin of half a path. */
FUNCTION void put_smooth_echo(const struct fan_record *fan, mask is_hit, struct cell_phase phase,
                              vfloat reflection_real, vfloat reflection_imaginary,
                              struct smooth_echo *echo)
{
    vfloat sine_of_phase, cosine_of_phase;
    const vfloat limited = smaller(larger(phase.range, SPLAT(-1.0e4f)), SPLAT(1.0e4f));
    sine_cosine_of_cycles(limited * fan->cycles_per_metre + fan->first_cycles, &sine_of_phase,
                          &cosine_of_phase);
    const vfloat position = limited * fan->bins_per_metre + fan->bin_at_reference;
    const mask is_counted =
        is_hit & MASK_OF(position >= 0.0f) & MASK_OF(position < (float)(fan->bins - 1));
    const vfloat kept = SELECT(is_counted, position, SPLAT(0.0f));
    const vint bin = VINT_OF(kept);
    const vfloat fraction = kept - VFLOAT_OF(bin);
    const vint bin_or_none = SELECT(is_counted, bin, bin - bin - 1);
    const vfloat real_part = phase.amplitude * (reflection_real * sine_of_phase +
                                                reflection_imaginary * cosine_of_phase);
    const vfloat imaginary_part = phase.amplitude * (reflection_imaginary * sine_of_phase -
                                                     reflection_real * cosine_of_phase);
    STORE_VFLOAT(real_part, echo->real_part);
    STORE_VFLOAT(imaginary_part, echo->imaginary_part);
    STORE_VFLOAT(fraction, echo->fraction);
    STORE_VFLOAT(phase.dither, echo->dither);
    STORE_VINT(bin_or_none, echo->bin);
}

/* The cells of a group of rays that meet the object. */
struct smooth_cells {
    mask is_hit;
    struct cell_phase phase;
    vfloat reflection_real, reflection_imaginary;
};

FUNCTION struct smooth_cells trace_smooth_group(const struct trace *trace,
                                                const struct wavefront_cell *cell)
{
    const struct fan_record *fan = &trace->fan;
    const struct aspect_ray broadside = broadside_aspect(&cell->ray);
    const struct sliced_hit hit = find_sliced_hit(trace, cell->elevation, &cell->ray, &broadside);
    const struct nearest_hit nearest = hit.nearest;
    const struct fan_ray ray = hit.ray;
    const mask on_object = cell->is_ray & MASK_OF(nearest.object == fan->only_object);
    const vfloat to_seabed = seabed_distance(trace, cell->ray.closest, cell->ray.direction,
                                             SPLAT(-fan->reference_range), on_object);
    struct smooth_cells cells;
    cells.is_hit = on_object & (hit.is_over_straight_water | MASK_OF(nearest.distance < to_seabed));
    const vfloat distance = SELECT(cells.is_hit, nearest.distance, SPLAT(0.0f));
    const GLOBAL struct object_record *object = &trace->objects[fan->only_object];
    const struct vector3 normal = object_normal(object, ray.closest, ray.direction, distance);
    const vfloat cosine = larger(-dot3(normal, ray.direction), SPLAT(1.0e-6f));
    const vfloat range = range_along(&ray, distance);
    /* Along a direction q across the ray, the gradient of the path is -2 n.q/(n.d), in ranges that
     * count wavelengths. */
    const vfloat gradient = 2.0f * ray.range_per_metre;
    cells.phase = integrate_cell(fan, cell, gradient * normal.x / cosine,
                                 gradient * dot3(normal, ray.upward) / cosine, range,
                                 ray.turn * (ray.wavefront + distance));
    cells.phase.amplitude =
        cells.phase.amplitude * ray.range_per_metre * refraction_gain(fan, &ray, distance);
    smooth_reflection(&object->surface, cosine, &cells.reflection_real,
                      &cells.reflection_imaginary);
    return cells;
}

/* Takes the cells of a fan that leaves one source to the other by physical optics (kernels/MATH.md,
 * "Image sources"). */
FUNCTION struct smooth_cells trace_smooth_images_group(const struct trace *trace,
                                                       const struct wavefront_cell *cell)
{
    const struct fan_record *fan = &trace->fan;
    GLOBAL const struct object_record *object = &trace->objects[fan->only_object];
    const struct image_hit hit = find_image_hit(trace, FACE_OF_OPTICS, &cell->ray, cell->is_ray);
    const struct image_path path = follow_path(trace, &cell->ray, &hit);
    const vfloat cosine_out = larger(hit.cosine, SPLAT(1.0e-4f));
    const vfloat bend = 1.0f + dot3(path.back.direction, cell->ray.direction);
    const vfloat gradient_along = bend * hit.normal.x / cosine_out;
    const vfloat gradient_across = bend * dot3(hit.normal, cell->ray.upward) / cosine_out +
                                   dot3(path.back.direction, cell->ray.upward);
    struct smooth_cells cells;
    cells.is_hit = path.is_open;
    cells.phase =
        integrate_cell(fan, cell, gradient_along, gradient_across, path.range, path.wavefront_out);
    cells.phase.amplitude = cells.phase.amplitude * (0.5f * trace->pair->echoes) *
                            (1.0f + path.cosine_back / cosine_out) * path.spreading;
    vfloat one_real, one_imaginary;
    smooth_reflection(&object->surface, 0.5f * (cosine_out + magnitude(path.cosine_back)),
                      &one_real, &one_imaginary);
    cells.reflection_real =
        one_real * path.reflection_real - one_imaginary * path.reflection_imaginary;
    cells.reflection_imaginary =
        one_real * path.reflection_imaginary + one_imaginary * path.reflection_real;
    return cells;
}

/* Shares an echo between the two bins about it, linearly in range. The pulse's envelope then moves
 * by the exact delay, with the error of linear interpolation between bins. */
FUNCTION void tally_smooth_echo(GLOBAL TALLY *tally, const struct smooth_echo *echo, int lane,
                                struct outcome_record *outcome)
{
    const int bin = echo->bin[lane];
    if (bin < 0)
        return;
    const float later = echo->fraction[lane];
    const float sooner = 1.0f - later;
    const float dither = echo->dither[lane];
    tally_add(&tally[2 * bin], 0, echo->real_part[lane] * sooner, dither, &outcome->faults);
    tally_add(&tally[2 * bin + 1], 0, echo->imaginary_part[lane] * sooner, dither,
              &outcome->faults);
    tally_add(&tally[2 * bin + 2], 0, echo->real_part[lane] * later, dither, &outcome->faults);
    tally_add(&tally[2 * bin + 3], 0, echo->imaginary_part[lane] * later, dither, &outcome->faults);
    outcome->impulses++;
}

FUNCTION void tally_smooth_echoes(const struct trace *trace, const struct smooth_cells *cells,
                                  mask is_counted, struct cell_phase phase, GLOBAL TALLY *line)
{
    struct smooth_echo echo;
    put_smooth_echo(&trace->fan, is_counted, phase, cells->reflection_real,
                    cells->reflection_imaginary, &echo);
    for (int lane = 0; lane < WIDTH; lane++)
        tally_smooth_echo(line, &echo, lane, trace->outcome);
}

/* Counts the echoes of a group's cells with all their parts. Most cells have one part. */
FUNCTION void tally_smooth_cells(const struct trace *trace, const struct smooth_cells *cells,
                                 GLOBAL TALLY *line)
{
    const struct fan_record *fan = &trace->fan;
    const vint parts = parts_of_cell(cells->phase);
    if (!ANY(cells->is_hit & MASK_OF(parts > 1))) {
        tally_smooth_echoes(trace, cells, cells->is_hit, whole_cell(fan, cells->phase), line);
        return;
    }
    for (int part = 0; part < CELL_PARTS_MAX; part++) {
        const mask is_part = cells->is_hit & MASK_OF(parts > part);
        if (!ANY(is_part))
            break;
        tally_smooth_echoes(trace, cells, is_part, part_of_cell(fan, cells->phase, part, parts),
                            line);
    }
}

/* Traces the segment of the sub-strip's fan: from the sonar and back, or between the image sources
 * of the pair. tallies: strips x bins x (real, imaginary). */
FUNCTION void trace_smooth_strip(const struct trace *trace, int by_images)
{
    const struct fan_record *fan = &trace->fan;
    GLOBAL TALLY *line = trace->tallies + (LONG_INDEX)trace->strip * fan->bins * 2;
    for (int stratum = 0; stratum < (int)fan->strata; stratum++)
        for (RECORD_WORD ray = first_ray_of_item(trace); ray < fan->rays; ray += ray_step(trace)) {
            count_rays(trace, ray, WIDTH);
            const struct wavefront_cell cell =
                wavefront_cell_at(trace, stratum, cell_shift_of(trace, stratum), ray);
            const struct smooth_cells cells = by_images ? trace_smooth_images_group(trace, &cell)
                                                        : trace_smooth_group(trace, &cell);
            tally_smooth_cells(trace, &cells, line);
        }
}

#endif
