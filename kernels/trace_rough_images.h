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

FUNCTION void trace_rough_images_group(const struct trace *trace, RECORD_WORD first_ray,
                                       struct image_echo *echo)
{
    const struct fan_record *fan = &trace->fan;
    const word number = SPLAT_WORD(first_ray) + LANE_NUMBERS;
    GLOBAL const struct object_record *object = &trace->objects[fan->only_object];
    vfloat along, across, dither;
    three_uniforms(trace->key, number, 0, &along, &across, &dither);
    const struct fan_ray ray =
        fan_ray_at(trace, strip_position(trace) + (along - 0.5f) * fan->strip_width,
                   fan->first_elevation + (VFLOAT_OF(number) + across) * fan->elevation_step);
    const struct image_hit hit =
        find_image_hit(trace, FACE_OF_SCATTERING, &ray, MASK_OF(number < fan->rays));
    const struct image_path path = follow_path(trace, &ray, &hit);
    const vfloat wavefront = fan->strip_width * fan->elevation_step * path.wavefront_out;
    const vfloat boundaries = path.reflection_real * path.reflection_real +
                              path.reflection_imaginary * path.reflection_imaginary;
    const struct vector3 out = reversed3(ray.direction), back = reversed3(path.back.direction);
    const vfloat energy = rough_scattering(&object->surface, hit.normal, out, back) *
                          fouling_factor(object, hit.point, hit.normal, out, back) *
                          path.cosine_back * wavefront * (path.spreading * path.spreading) *
                          boundaries * (trace->pair->echoes * trace->pair->echoes * fan->quanta);
    const vfloat kept = SELECT(path.is_open, energy, SPLAT(0.0f));
    const struct bin_pair bins =
        bins_about(path.range * fan->bins_per_metre + fan->bin_at_reference);
    STORE_VFLOAT(kept, echo->energy);
    STORE_VFLOAT(dither, echo->dither);
    STORE_VINT(bins.bin, echo->bin);
    STORE_VFLOAT(bins.later, echo->later);
}

/* Traces the segment of the strip's fan into the object's tile. */
FUNCTION void trace_rough_images_strip(const struct trace *trace)
{
    const struct fan_record *fan = &trace->fan;
    GLOBAL const struct object_record *object = &trace->objects[fan->only_object];
    GLOBAL TALLY *line = tile_line(trace, object, TILE_ENERGY, fan->first_strip + trace->strip);
    for (RECORD_WORD ray = first_ray_of_item(trace); ray < fan->rays; ray += ray_step(trace)) {
        struct image_echo echo;
        count_rays(trace, ray, WIDTH);
        trace_rough_images_group(trace, ray, &echo);
        for (int lane = 0; lane < WIDTH; lane++) {
            const int bin = echo.bin[lane] - object->tile_first_bin;
            if (!line || bin < -1 || bin >= object->tile_bins || echo.energy[lane] == 0.0f)
                continue; /* beyond the patch's ranges */
            tally_shares(line, object->tile_bins, 0, bin, echo.later[lane], echo.energy[lane],
                         echo.dither[lane], &trace->outcome->faults);
            trace->outcome->impulses++;
        }
    }
}

#endif
