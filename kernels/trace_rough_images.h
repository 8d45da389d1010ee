/* The incoherent part by image sources. The fan leaves one source, and every hit on the rough
 * object connects to the other (kernels/MATH.md, "Image sources"). Both sources are points. */
#ifndef SONJECT_KERNELS_TRACE_ROUGH_IMAGES_H
#define SONJECT_KERNELS_TRACE_ROUGH_IMAGES_H

#include "image_sources.h"
#include "trace_rough.h"

/* The energies of one group of rays, lane by lane, ready to be tallied. */
struct image_echo {
    float energy[WIDTH]; /* quanta; 0: none */
    float dither[WIDTH]; /* uniform deviate for rounding */
    int bin[WIDTH];      /* the first of two */
    float later[WIDTH];  /* share of the second */
};

FUNCTION void trace_rough_images_group(const struct fan_record *fan,
                                       GLOBAL const struct ray_piece_record *pieces,
                                       GLOBAL const struct image_pair_record *pair,
                                       GLOBAL const struct object_record *objects, int strip,
                                       struct random_key key, RECORD_WORD first_ray,
                                       struct image_echo *echo, struct outcome_record *outcome)
{
    const word number = SPLAT_WORD(first_ray) + LANE_NUMBERS;
    GLOBAL const struct object_record *object = &objects[fan->only_object];
    vfloat along, across, dither;
    three_uniforms(key, number, 0, &along, &across, &dither);
    const struct fan_ray ray =
        fan_ray_at(fan, pieces, strip_position(fan, strip) + (along - 0.5f) * fan->strip_width,
                   fan->first_elevation + (VFLOAT_OF(number) + across) * fan->elevation_step);
    const struct image_hit hit =
        find_image_hit(fan, pair, objects, FACE_OF_SCATTERING, &ray, MASK_OF(number < fan->rays));
    const struct image_path path = follow_path(fan, pieces, pair, objects, &ray, &hit, outcome);
    const vfloat wavefront = fan->strip_width * fan->elevation_step * path.wavefront_out;
    const vfloat boundaries = path.reflection_real * path.reflection_real +
                              path.reflection_imaginary * path.reflection_imaginary;
    const struct vector3 out = reversed3(ray.direction), back = reversed3(path.back.direction);
    const vfloat energy = rough_scattering(&object->surface, hit.normal, out, back) *
                          fouling_factor(object, hit.point, hit.normal, out, back) *
                          path.cosine_back * wavefront * (path.spreading * path.spreading) *
                          boundaries * (pair->echoes * pair->echoes * fan->quanta);
    const vfloat kept = SELECT(path.is_open, energy, SPLAT(0.0f));
    const struct bin_pair bins =
        bins_about(path.range * fan->bins_per_metre + fan->bin_at_reference);
    STORE_VFLOAT(kept, echo->energy);
    STORE_VFLOAT(dither, echo->dither);
    STORE_VINT(bins.bin, echo->bin);
    STORE_VFLOAT(bins.later, echo->later);
}

/* Traces the share `segment` of a strip's fan into the object's tile. */
FUNCTION struct outcome_record trace_rough_images_strip(
    const struct fan_record *fan, GLOBAL const struct ray_piece_record *pieces,
    GLOBAL const struct image_pair_record *pair, GLOBAL const struct object_record *objects,
    GLOBAL TALLY *tiles, int strip, int segment)
{
    struct outcome_record outcome = {0, 0, 0, 0};
    const struct random_key key = key_of_strip(fan, strip);
    GLOBAL const struct object_record *object = &objects[fan->only_object];
    GLOBAL TALLY *line = tile_line(object, tiles, TILE_ENERGY, fan->first_strip + strip);
    for (RECORD_WORD ray = first_ray_of_item(segment); ray < fan->rays; ray += ray_step(fan)) {
        struct image_echo echo;
        outcome.rays += rays_from(fan, ray, WIDTH);
        trace_rough_images_group(fan, pieces, pair, objects, strip, key, ray, &echo, &outcome);
        for (int lane = 0; lane < WIDTH; lane++) {
            const int bin = echo.bin[lane] - object->tile_first_bin;
            if (!line || bin < -1 || bin >= object->tile_bins || echo.energy[lane] == 0.0f)
                continue; /* beyond the patch's ranges */
            tally_shares(line, object->tile_bins, 0, bin, echo.later[lane], echo.energy[lane],
                         echo.dither[lane], &outcome.faults);
            outcome.impulses++;
        }
    }
    outcome.queries += outcome.rays;
    return outcome;
}

#endif
