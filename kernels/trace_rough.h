/* The incoherent part at one interaction: seabed and rough surfaces. Each ray carries the energy of
 * its share of the wavefront, a strip wide (kernels/MATH.md, "Rough surfaces"). */
#ifndef SONJECT_KERNELS_TRACE_ROUGH_H
#define SONJECT_KERNELS_TRACE_ROUGH_H

#include "aspects.h"
#include "fan.h"
#include "fouling.h"
#include "intersection.h"
#include "random.h"
#include "reflectivity_map.h"
#include "seabed.h"
#include "slices.h"
#include "surface.h"
#include "tally.h"

/* The way from a hit to the source, and whether it is open. */
struct connection {
    vfloat range;             /* half the path less the reference range */
    vfloat cosine;            /* cosine of the angle between the normal and the way to the source */
    struct vector3 direction; /* unit, to the source */
    mask is_open;
};

/* Connects a hit to a random point of the source's square about the receiver, spanned by x and the
 * fan's upward direction, and tests whether the way is open. distance: along the fan's ray. The
 * image knows source and receiver, and focuses their echo at the hit. */
FUNCTION struct connection connect_to_source(const struct trace *trace, const struct fan_ray *ray,
                                             const struct aspect_ray *squinted, struct vector3 hit,
                                             struct vector3 normal, vfloat distance, vfloat along,
                                             vfloat across)
{
    const struct fan_record *fan = &trace->fan;
    /* The way from the hit back to the receiver is -direction * r. If layers bend the ray, the
     * receiver only seems to be there. The source point lies an offset beside it. */
    const vfloat r = (ray->wavefront + distance) / squinted->cosine;
    const vfloat range = ray->range_at_closest + distance;
    const vfloat offset_x = (along - 0.5f) * fan->source_side;
    const vfloat offset_up = (across - 0.5f) * fan->source_side;
    const vfloat square = offset_x * offset_x + offset_up * offset_up;
    const vfloat path = SQUARE_ROOT((r * r + square) - 2.0f * r * offset_x * squinted->sine);
    const struct vector3 way =
        vector3_of((offset_x - r * squinted->direction.x) / path,
                   (offset_up * ray->upward.y - r * squinted->direction.y) / path,
                   (offset_up * ray->upward.z - r * squinted->direction.z) / path);
    struct connection connection;
    connection.range = range + 0.5f * square / (path + r);
    connection.cosine = dot3(way, normal);
    connection.direction = way;
    const struct vector3 start = along3(hit, normal, SPLAT(START_OFF_SURFACE));
    const vfloat obstacle = find_obstacle(trace->objects, fan->objects, start, way, path);
    connection.is_open = MASK_OF(obstacle > path) & MASK_OF(connection.cosine > 0.0f);
    connection.is_open = is_clear_of_relief(trace, start, way, path, connection.is_open);
    return connection;
}

/* The energies of one group of rays, lane by lane, ready to be tallied. */
struct rough_echo {
    float seabed[WIDTH], target[WIDTH];             /* quanta; 0: none */
    int seabed_strip[WIDTH], target_strip[WIDTH];   /* numbers on the whole track, in focus */
    int seabed_bin[WIDTH], target_bin[WIDTH];       /* the first of two */
    float seabed_later[WIDTH], target_later[WIDTH]; /* share of the second */
    int object[WIDTH];
    float row[WIDTH], column[WIDTH]; /* place in the reflectivity map */
    float dither[WIDTH];             /* uniform deviate for rounding */
};

/* Returns a strip of a plane of an object's tile, from its first bin on; 0 if there is none. */
FUNCTION GLOBAL TALLY *tile_line(const struct trace *trace,
                                 GLOBAL const struct object_record *object, int plane, int strip)
{
    const int row = strip - object->tile_first_strip;
    if (row < 0 || row >= object->tile_strips)
        return 0;
    return trace->tiles + object->tile_offset +
           ((LONG_INDEX)plane * object->tile_strips + row) * object->tile_bins;
}

/* The tallies of one strip's rays. */
struct rough_tallies {
    int first_strip, strips; /* strips of the seabed's tallies, in the whole track */
    int has_objects;         /* the strip's rays tally objects' echoes */
    int is_shared;           /* rays of other strips tally in the same places */
};

FUNCTION struct rough_tallies rough_tallies_of(const struct trace *trace)
{
    const struct fan_record *fan = &trace->fan;
    const int core = fan->first_strip + trace->strip - fan->aspects.core_first_strip;
    struct rough_tallies tallies;
    tallies.is_shared = has_aspects(fan);
    tallies.first_strip = tallies.is_shared ? fan->aspects.tally_first_strip : fan->first_strip;
    tallies.strips = tallies.is_shared ? fan->aspects.tally_strips : fan->strips;
    tallies.has_objects = !tallies.is_shared || (core >= 0 && core < fan->aspects.core_strips);
    return tallies;
}

/* Tallies the seabed energy that an object hides. */
FUNCTION void tally_lost_seabed(const struct trace *trace,
                                GLOBAL const struct object_record *object,
                                const struct rough_tallies *tallies, const struct rough_echo *echo,
                                int lane, float quanta)
{
    GLOBAL TALLY *line = tile_line(trace, object, TILE_LOST, echo->seabed_strip[lane]);
    const int bin = echo->seabed_bin[lane];
    const int column = bin - object->tile_first_bin;
    if (line && (column >= 0 || bin < 0) &&
        (column + 1 < object->tile_bins || bin + 1 >= trace->fan.bins))
        tally_shares(line, object->tile_bins, tallies->is_shared, column, echo->seabed_later[lane],
                     quanta, echo->dither[lane], &trace->outcome->faults);
    else
        trace->outcome->faults |= FAULT_OUTSIDE_TILE;
}

/* Tallies the seabed's energy, and again if an object hides it. */
FUNCTION void tally_rough_seabed(const struct trace *trace, const struct rough_tallies *tallies,
                                 const struct rough_echo *echo, int lane)
{
    const struct fan_record *fan = &trace->fan;
    const int object = echo->object[lane];
    const int bin = echo->seabed_bin[lane];
    const int strip = echo->seabed_strip[lane] - tallies->first_strip;
    if (!(echo->seabed[lane] > 0.0f) || bin < -1 || bin >= fan->bins || strip < 0 ||
        strip >= tallies->strips)
        return;
    const float quanta = echo->seabed[lane] * map_value(trace, echo->row[lane], echo->column[lane]);
    tally_shares(trace->tallies + (LONG_INDEX)strip * fan->bins, fan->bins, tallies->is_shared, bin,
                 echo->seabed_later[lane], quanta, echo->dither[lane], &trace->outcome->faults);
    trace->outcome->impulses += object < 0;
    if (object >= 0)
        tally_lost_seabed(trace, &trace->objects[object], tallies, echo, lane, quanta);
}

/* Tallies one lane. */
FUNCTION void tally_rough_echo(const struct trace *trace, const struct rough_tallies *tallies,
                               const struct rough_echo *echo, int lane)
{
    tally_rough_seabed(trace, tallies, echo, lane);
    if (echo->object[lane] < 0 || !tallies->has_objects)
        return;
    GLOBAL const struct object_record *object = &trace->objects[echo->object[lane]];
    const int strip = echo->target_strip[lane];
    const int bin = echo->target_bin[lane] - object->tile_first_bin;
    const float later = echo->target_later[lane];
    const int nearest = bin + (later >= 0.5f);
    GLOBAL TALLY *energy = tile_line(trace, object, TILE_ENERGY, strip);
    GLOBAL TALLY *footprint = tile_line(trace, object, TILE_FOOTPRINT, strip);
    if (!energy || !footprint || nearest < 0 || nearest >= object->tile_bins)
        return; /* beyond the patch's ranges, or its ends */
    tally_add(&footprint[nearest], tallies->is_shared, 1.0f, 0.5f, &trace->outcome->faults);
    tally_shares(energy, object->tile_bins, tallies->is_shared, bin, later, echo->target[lane],
                 echo->dither[lane], &trace->outcome->faults);
    trace->outcome->impulses += echo->target[lane] > 0.0f;
}

/* Returns f cos of the objects that rays meet, towards the source, and their echoes' range. */
FUNCTION vfloat scattering_of_targets(const struct trace *trace, const struct fan_ray *ray,
                                      const struct aspect_ray *squinted, struct nearest_hit nearest,
                                      mask on_object, vfloat source_along, vfloat source_across,
                                      vfloat *range)
{
    const struct fan_record *fan = &trace->fan;
    vfloat scattering = SPLAT(0.0f);
    const int objects_end = ANY(on_object) ? fan->objects : 0;
    FOR_SURFACES_MET (i, 0, objects_end, nearest.object, on_object) {
        const mask here = on_object & MASK_OF(nearest.object == i);
        if (!ANY(here))
            continue;
        const vfloat distance = SELECT(here, nearest.distance, SPLAT(0.0f));
        const struct surface_face face = object_face(
            &trace->objects[i], FACE_OF_SCATTERING, squinted->start, squinted->direction, distance);
        const struct vector3 normal = face.normal;
        const struct vector3 back = reversed3(squinted->direction);
        struct vector3 out = back;
        mask is_open = here;
        if (fan->source_side > 0.0f) {
            const struct connection way = connect_to_source(
                trace, ray, squinted,
                lifted_point(along3(squinted->start, squinted->direction, distance), &face), normal,
                distance * squinted->cosine, source_along, source_across);
            trace->outcome->queries += count_lanes(here);
            is_open = is_open & way.is_open;
            out = way.direction;
            *range = SELECT(here, way.range, *range);
        }
        scattering = SELECT(
            is_open,
            rough_scattering(&trace->objects[i].surface, normal, back, out) * dot3(normal, out) *
                fouling_factor(&trace->objects[i],
                               along3(squinted->start, squinted->direction, distance), normal, back,
                               out),
            scattering);
    }
    return scattering;
}

/* The seabed's return where a ray meets it, as if no object stood before it. */
struct seabed_return {
    struct vector3 point;
    vfloat energy, range, straight_range; /* energy in quanta; range by way of the source's point */
    mask is_open;
};

/* Returns the seabed's return. strip_of_cell: times wavefront, the area across the ray. on_object:
 * rays that meet an object first, which may hide the seabed's way to the source. */
FUNCTION struct seabed_return seabed_return_of(const struct trace *trace, const struct fan_ray *ray,
                                               const struct aspect_ray *squinted, vfloat to_seabed,
                                               mask is_ray, mask on_object, vfloat strip_of_cell,
                                               vfloat source_along, vfloat source_across)
{
    const struct fan_record *fan = &trace->fan;
    struct seabed_return bed;
    const vfloat distance = to_seabed * squinted->cosine;
    bed.straight_range = ray->range_at_closest + distance;
    bed.range = bed.straight_range;
    bed.point = along3(squinted->start, squinted->direction, to_seabed);
    bed.is_open = is_ray & MASK_OF(to_seabed < 0.5f * FAR_AWAY);
    const struct vector3 normal = seabed_normal(trace, bed.point, squinted->direction);
    vfloat cosine = has_relief(trace) ? -dot3(normal, squinted->direction) : -squinted->direction.z;
    if (fan->source_side > 0.0f && ANY(bed.is_open)) {
        const struct connection way = connect_to_source(trace, ray, squinted, bed.point, normal,
                                                        distance, source_along, source_across);
        trace->outcome->queries += count_lanes(bed.is_open);
        bed.range = way.range;
        cosine = way.cosine;
        bed.is_open = bed.is_open & (way.is_open | on_object);
    }
    vfloat weight = squinted->weight * fan->quanta;
    if (has_beam(fan)) {
        weight = weight * beam_spread(fan, squinted, bed.straight_range);
        bed.range = whole_range(fan, squinted, bed.range);
    }
    const vfloat gain = refraction_gain(fan, ray, distance);
    bed.energy = fan->seabed_lambert * cosine * strip_of_cell * (ray->wavefront + distance) *
                 (gain * gain) * weight;
    return bed;
}

/* Traces one group of WIDTH rays of a strip. Ray i lies between edges[i] and edges[i + 1],
 * elevations in rad. */
FUNCTION void trace_rough_group(const struct trace *trace, RECORD_WORD first_ray,
                                struct rough_echo *echo)
{
    const struct fan_record *fan = &trace->fan;
    const mask is_ray = MASK_OF(SPLAT_WORD(first_ray) + LANE_NUMBERS < fan->rays);
    const word number = SPLAT_WORD(fan->first_ray + first_ray) + LANE_NUMBERS;
    const vfloat lower = LOAD_VFLOAT(trace->edges + first_ray);
    const vfloat step = LOAD_VFLOAT(trace->edges + first_ray + 1) - lower;
    const int own_strip = fan->first_strip + trace->strip;
    vfloat along, across, dither;
    three_uniforms(trace->key, number, 0, &along, &across, &dither);
    const float spread = has_beam(fan) ? 0.0f : fan->strip_width; /* pings are points */
    const vfloat x = strip_position(trace) + (along - 0.5f) * spread;
    const struct fan_ray ray = fan_ray_at(trace, x, lower + across * step);
    /* Distances along the squinted ray times its cosine are distances along the fan's ray. */
    const struct aspect_ray squinted =
        aspect_ray_of(fan, &ray, (RECORD_WORD)(fan->track_strip + own_strip), number, dither);
    const vfloat strip_of_cell = fan->strip_width * step * squinted.cosine;
    const vfloat to_seabed = seabed_distance(trace, squinted.start, squinted.direction,
                                             SPLAT(-fan->reference_range), is_ray);
    const struct sliced_hit target = find_sliced_hit(trace, lower + across * step, &ray, &squinted);
    const struct nearest_hit nearest = target.nearest;
    const mask on_object =
        is_ray & (target.is_over_straight_water | MASK_OF(nearest.distance < to_seabed));
    /* A point source at the receiver sees all that its rays meet, so nothing is tested. */
    vfloat source_along = SPLAT(0.5f), source_across = SPLAT(0.5f);
    if (fan->source_side > 0.0f)
        two_uniforms(trace->key, number, 1, &source_along, &source_across);
    const struct seabed_return bed =
        seabed_return_of(trace, &ray, &squinted, to_seabed, is_ray, on_object, strip_of_cell,
                         source_along, source_across);

    const vfloat to_target = SELECT(on_object, nearest.distance, SPLAT(0.0f));
    const vfloat target_distance = to_target * squinted.cosine;
    vfloat target_range = range_along(&target.ray, target_distance);
    const vfloat target_gain = refraction_gain(fan, &target.ray, target_distance);
    vfloat target_weight = squinted.weight * fan->quanta;
    if (has_beam(fan))
        target_weight = target_weight * beam_spread(fan, &squinted, target_range);
    const vfloat target_area = strip_of_cell * target.ray.turn *
                               (target.ray.wavefront + target_distance) *
                               (target_gain * target_gain) * target_weight;
    const vfloat energy =
        target_area * scattering_of_targets(trace, &target.ray, &target.squinted, nearest,
                                            on_object, source_along, source_across, &target_range);
    if (has_beam(fan))
        target_range = whole_range(fan, &squinted, target_range);

    const struct bin_pair seabed_bins = bins_about(SELECT(
        bed.is_open, bed.range * fan->bins_per_metre + fan->bin_at_reference, SPLAT(BEFORE_BINS)));
    const struct bin_pair target_bins =
        bins_about(target_range * fan->bins_per_metre + fan->bin_at_reference);
    const vint object_numbers = SELECT(on_object, nearest.object, VINT_OF(SPLAT(-1.0f)));
    const vfloat kept = SELECT(bed.is_open, bed.energy, SPLAT(0.0f));
    const vfloat bed_x = has_relief(trace) || has_beam(fan) ? bed.point.x : x;
    const vfloat map_range =
        has_relief(trace) ? range_in_plan(trace, bed.point) : bed.straight_range;
    const struct map_place place = place_in_map(fan, bed_x, map_range);
    vint seabed_strips = SPLAT_VINT(own_strip);
    vint target_strips = seabed_strips;
    if (has_aspects(fan)) {
        if (has_relief(trace))
            seabed_strips = track_strip_at(fan, bed.point.x);
        target_strips =
            track_strip_at(fan, target.squinted.start.x + target.squinted.direction.x * to_target);
    }
    STORE_VFLOAT(kept, echo->seabed);
    STORE_VFLOAT(energy, echo->target);
    STORE_VINT(seabed_strips, echo->seabed_strip);
    STORE_VINT(target_strips, echo->target_strip);
    STORE_VINT(seabed_bins.bin, echo->seabed_bin);
    STORE_VINT(target_bins.bin, echo->target_bin);
    STORE_VFLOAT(seabed_bins.later, echo->seabed_later);
    STORE_VFLOAT(target_bins.later, echo->target_later);
    STORE_VINT(object_numbers, echo->object);
    STORE_VFLOAT(place.row, echo->row);
    STORE_VFLOAT(place.column, echo->column);
    STORE_VFLOAT(dither, echo->dither);
}

/* Traces the segment of the strip's fan. */
FUNCTION void trace_rough_strip(const struct trace *trace)
{
    const struct rough_tallies tallies = rough_tallies_of(trace);
    for (RECORD_WORD ray = first_ray_of_item(trace); ray < trace->fan.rays;
         ray += ray_step(trace)) {
        struct rough_echo echo;
        count_rays(trace, ray, WIDTH);
        trace_rough_group(trace, ray, &echo);
        for (int lane = 0; lane < WIDTH; lane++)
            tally_rough_echo(trace, &tallies, &echo, lane);
    }
    /* Strips that another chunk's launch traces for itself are not counted here. */
    trace->outcome->rays = tallies.has_objects ? trace->outcome->rays : 0;
    trace->outcome->queries = tallies.has_objects ? trace->outcome->queries : 0;
}

#endif
