/* The coherent part by image sources. The fan leaves one source, and physical optics takes the
 * sound from a smooth object to the other source (kernels/MATH.md, "Image sources"). */
#ifndef SONJECT_KERNELS_TRACE_SMOOTH_IMAGES_H
#define SONJECT_KERNELS_TRACE_SMOOTH_IMAGES_H

#include "image_sources.h"
#include "trace_smooth.h"

FUNCTION struct smooth_cells trace_smooth_images_group(const struct fan_record *fan,
                                                       GLOBAL const struct ray_piece_record *pieces,
                                                       GLOBAL const struct image_pair_record *pair,
                                                       GLOBAL const struct object_record *objects,
                                                       int strip, int stratum,
                                                       struct random_key key, RECORD_WORD first_ray,
                                                       struct outcome_record *outcome)
{
    const struct wavefront_cell cell = wavefront_cell_at(
        fan, pieces, strip, stratum, cell_shift_of(fan, strip, stratum), key, first_ray);
    GLOBAL const struct object_record *object = &objects[fan->only_object];
    const struct image_hit hit =
        find_image_hit(fan, pair, objects, FACE_OF_OPTICS, &cell.ray, cell.is_ray);
    const struct image_path path =
        follow_path(fan, pieces, pair, objects, &cell.ray, &hit, outcome);
    const vfloat cosine_out = larger(hit.cosine, SPLAT(1.0e-4f));
    const vfloat bend = 1.0f + dot3(path.back.direction, cell.ray.direction);
    const vfloat gradient_along = bend * hit.normal.x / cosine_out;
    const vfloat gradient_across = bend * dot3(hit.normal, cell.ray.upward) / cosine_out +
                                   dot3(path.back.direction, cell.ray.upward);
    struct smooth_cells cells;
    cells.is_hit = path.is_open;
    cells.phase =
        integrate_cell(fan, &cell, gradient_along, gradient_across, path.range, path.wavefront_out);
    cells.phase.amplitude = cells.phase.amplitude * (0.5f * pair->echoes) *
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

/* Traces the share `segment` of a sub-strip's fan. tally: strips x bins x (real, imaginary). */
FUNCTION struct outcome_record trace_smooth_images_strip(
    const struct fan_record *fan, GLOBAL const struct ray_piece_record *pieces,
    GLOBAL const struct image_pair_record *pair, GLOBAL const struct object_record *objects,
    GLOBAL TALLY *tally, int strip, int segment)
{
    struct outcome_record outcome = {0, 0, 0, 0};
    const struct random_key key = key_of_strip(fan, strip);
    GLOBAL TALLY *line = tally + (LONG_INDEX)strip * fan->bins * 2;
    for (int stratum = 0; stratum < (int)fan->strata; stratum++)
        for (RECORD_WORD ray = first_ray_of_item(segment); ray < fan->rays; ray += ray_step(fan)) {
            outcome.rays += rays_from(fan, ray, WIDTH);
            const struct smooth_cells cells = trace_smooth_images_group(
                fan, pieces, pair, objects, strip, stratum, key, ray, &outcome);
            tally_smooth_cells(fan, &cells, line, &outcome);
        }
    outcome.queries += outcome.rays;
    return outcome;
}

#endif
