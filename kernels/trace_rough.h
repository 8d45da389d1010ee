/* The incoherent part at one interaction: seabed and rough surfaces. Each ray carries the energy of
 * the strip of wavefront that it stands for (kernels/MATH.md, "Rough surfaces"). */
#ifndef SONJECT_KERNELS_TRACE_ROUGH_H
#define SONJECT_KERNELS_TRACE_ROUGH_H

#include "aspects.h"
#include "fan.h"
#include "intersection.h"
#include "random.h"
#include "reflectivity_map.h"
#include "seabed.h"
#include "surface.h"
#include "tally.h"

/* A hit as seen by the source: where its echo lies and whether it gets there. */
struct connection {
    vfloat range;             /* half the path less the reference range */
    vfloat cosine;            /* of the angle between normal and the way to the source */
    struct vector3 direction; /* from the hit */
    mask is_open;
};

/* Connects a hit to a random point of the source's rectangle, which spans x and the fan's upward
 * direction about the receiver, and tests whether anything is in between. distance: along the fan's
 * ray. The image knows where source and receiver are, and focuses their echo at the hit. */
FUNCTION struct connection connect_to_source(const struct fan_record *fan,
                                             GLOBAL const struct object_record *objects,
                                             const struct fan_ray *ray,
                                             const struct aspect_ray *squinted, struct vector3 hit,
                                             struct vector3 normal, vfloat distance, vfloat along,
                                             vfloat across)
{
    /* from the hit back to the receiver (to where it seems to be, if layers bend the ray) is
     * -direction * r; the source point lies an offset beside */
    const vfloat r = (ray->wavefront + distance) / squinted->cosine;
    const vfloat range = ray->range_at_closest + distance;
    const vfloat offset_x = (along - 0.5f) * fan->source_side;
    const vfloat offset_up = (across - 0.5f) * fan->source_side;
    const vfloat square = offset_x * offset_x + offset_up * offset_up;
    const vfloat path = SQUARE_ROOT((r * r + square) - 2.0f * r * offset_x * squinted->sine);
    struct vector3 way;
    way.x = (offset_x - r * squinted->direction.x) / path;
    way.y = (offset_up * ray->upward.y - r * squinted->direction.y) / path;
    way.z = (offset_up * ray->upward.z - r * squinted->direction.z) / path;
    struct connection connection;
    connection.range = range + 0.5f * square / (path + r);
    connection.cosine = dot3(way, normal);
    connection.direction = way;
    const struct vector3 start = along3(hit, normal, SPLAT(START_OFF_SURFACE));
    const vfloat obstacle = find_obstacle(objects, fan->objects, start, way, path);
    connection.is_open = MASK_OF(obstacle > path) & MASK_OF(connection.cosine > 0.0f);
    connection.is_open = is_clear_of_relief(fan, objects, start, way, path, connection.is_open);
    return connection;
}

/* Energies of one group of rays, lane by lane, ready to be tallied. */
struct rough_echo {
    float seabed[WIDTH], target[WIDTH];             /* quanta; 0: none */
    int seabed_strip[WIDTH], target_strip[WIDTH];   /* of the whole track, where they focus */
    int seabed_bin[WIDTH], target_bin[WIDTH];       /* the first of two */
    float seabed_later[WIDTH], target_later[WIDTH]; /* share of the second */
    int object[WIDTH];
    float row[WIDTH], column[WIDTH]; /* of the reflectivity map */
    float chance[WIDTH];             /* of rounding up */
};

/* A strip of an object's tile, from its first bin on; 0: there is none. */
FUNCTION GLOBAL TALLY *tile_line(GLOBAL const struct object_record *object, GLOBAL TALLY *tiles,
                                 int plane, int strip)
{
    const int row = strip - object->tile_first_strip;
    if (row < 0 || row >= object->tile_strips)
        return 0;
    return tiles + object->tile_offset +
           ((long)plane * object->tile_strips + row) * object->tile_bins;
}

/* Where a ray of a strip tallies. */
struct rough_tallies {
    GLOBAL TALLY *seabed, *tiles;
    int first_strip, strips; /* of the seabed's tallies, in the whole track */
    int has_objects;         /* the strip's rays tally what objects return */
    int is_shared;           /* other strips' rays do so in the same places */
};

/* Those of a launch's strip. */
FUNCTION struct rough_tallies rough_tallies_of(const struct fan_record *fan, int strip,
                                               GLOBAL TALLY *seabed, GLOBAL TALLY *tiles)
{
    const int core = fan->first_strip + strip - fan->aspects.core_first_strip;
    struct rough_tallies tallies;
    tallies.seabed = seabed;
    tallies.tiles = tiles;
    tallies.is_shared = has_aspects(fan);
    tallies.first_strip = tallies.is_shared ? fan->aspects.tally_first_strip : fan->first_strip;
    tallies.strips = tallies.is_shared ? fan->aspects.tally_strips : fan->strips;
    tallies.has_objects = !tallies.is_shared || (core >= 0 && core < fan->aspects.core_strips);
    return tallies;
}

/* What an object hides of the seabed's energy. */
FUNCTION void tally_lost_seabed(const struct fan_record *fan,
                                GLOBAL const struct object_record *object,
                                const struct rough_tallies *tallies, const struct rough_echo *echo,
                                int lane, float quanta, struct outcome_record *outcome)
{
    GLOBAL TALLY *line = tile_line(object, tallies->tiles, TILE_LOST, echo->seabed_strip[lane]);
    const int bin = echo->seabed_bin[lane];
    const int column = bin - object->tile_first_bin;
    if (line && (column >= 0 || bin < 0) &&
        (column + 1 < object->tile_bins || bin + 1 >= fan->bins))
        tally_shares(line, object->tile_bins, tallies->is_shared, column, echo->seabed_later[lane],
                     quanta, echo->chance[lane], &outcome->faults);
    else
        outcome->faults |= FAULT_OUTSIDE_TILE;
}

/* The seabed's energy, and again where an object hides it. */
FUNCTION void tally_rough_seabed(const struct fan_record *fan,
                                 GLOBAL const struct object_record *objects,
                                 GLOBAL const float *map, const struct rough_tallies *tallies,
                                 const struct rough_echo *echo, int lane,
                                 struct outcome_record *outcome)
{
    const int object = echo->object[lane];
    const int bin = echo->seabed_bin[lane];
    const int strip = echo->seabed_strip[lane] - tallies->first_strip;
    if (!(echo->seabed[lane] > 0.0f) || bin < -1 || bin >= fan->bins || strip < 0 ||
        strip >= tallies->strips)
        return;
    const float quanta =
        echo->seabed[lane] * map_value(fan, map, echo->row[lane], echo->column[lane]);
    tally_shares(tallies->seabed + (long)strip * fan->bins, fan->bins, tallies->is_shared, bin,
                 echo->seabed_later[lane], quanta, echo->chance[lane], &outcome->faults);
    outcome->impulses += object < 0;
    if (object >= 0)
        tally_lost_seabed(fan, &objects[object], tallies, echo, lane, quanta, outcome);
}

/* Tallies one lane. */
FUNCTION void tally_rough_echo(const struct fan_record *fan,
                               GLOBAL const struct object_record *objects, GLOBAL const float *map,
                               const struct rough_tallies *tallies, const struct rough_echo *echo,
                               int lane, struct outcome_record *outcome)
{
    tally_rough_seabed(fan, objects, map, tallies, echo, lane, outcome);
    if (echo->object[lane] < 0 || !tallies->has_objects)
        return;
    GLOBAL const struct object_record *object = &objects[echo->object[lane]];
    const int strip = echo->target_strip[lane];
    const int bin = echo->target_bin[lane] - object->tile_first_bin;
    const float later = echo->target_later[lane];
    const int nearest = bin + (later >= 0.5f);
    GLOBAL TALLY *energy = tile_line(object, tallies->tiles, TILE_ENERGY, strip);
    GLOBAL TALLY *footprint = tile_line(object, tallies->tiles, TILE_FOOTPRINT, strip);
    if (!energy || !footprint || nearest < 0 || nearest >= object->tile_bins)
        return; /* beyond the patch's ranges, or its ends */
    tally_add(&footprint[nearest], tallies->is_shared, 1.0f, 0.5f, &outcome->faults);
    tally_shares(energy, object->tile_bins, tallies->is_shared, bin, later, echo->target[lane],
                 echo->chance[lane], &outcome->faults);
    outcome->impulses += echo->target[lane] > 0.0f;
}

/* A ray of the fan and what it meets. */
struct rough_ray {
    struct fan_ray ray;
    struct aspect_ray squinted;
    vfloat strip_of_cell; /* times wavefront: the area across the ray that it stands for */
    vfloat source_along, source_across; /* of the point of the source, shares of its sides */
    vfloat to_seabed;                   /* m along the squinted ray */
    struct nearest_hit nearest;
    mask is_ray, on_object;
};

/* distances along the squinted ray times its cosine are those along the fan's */
FUNCTION struct rough_ray rough_ray_at(const struct fan_record *fan,
                                       GLOBAL const struct ray_piece_record *pieces,
                                       GLOBAL const struct object_record *objects, int strip,
                                       struct random_key key, word number, vfloat *chance)
{
    struct rough_ray rough;
    vfloat along, across;
    three_uniforms(key, number, 0, &along, &across, chance);
    const float spread = has_beam(fan) ? 0.0f : fan->strip_width; /* pings are points */
    rough.is_ray = MASK_OF(number < fan->rays);
    rough.ray =
        fan_ray_at(fan, pieces, strip_position(fan, strip) + (along - 0.5f) * spread,
                   fan->first_elevation + (VFLOAT_OF(number) + across) * fan->elevation_step);
    rough.squinted =
        aspect_ray_of(fan, &rough.ray, (RECORD_WORD)(fan->first_strip + strip), number, *chance);
    rough.strip_of_cell = fan->strip_width * fan->elevation_step * rough.squinted.cosine;
    rough.to_seabed = seabed_distance(fan, objects, rough.squinted.start, rough.squinted.direction,
                                      SPLAT(-fan->reference_range), rough.is_ray);
    rough.nearest = find_nearest_hit(objects, fan->objects, rough.squinted.start,
                                     rough.squinted.direction, -fan->reference_range);
    rough.on_object = rough.is_ray & MASK_OF(rough.nearest.distance < rough.to_seabed);
    rough.source_along = SPLAT(0.5f);
    rough.source_across = SPLAT(0.5f);
    /* a point source at the receiver sees what its rays meet: nothing is to be tested */
    if (fan->source_side > 0.0f)
        two_uniforms(key, number, 1, &rough.source_along, &rough.source_across);
    return rough;
}

/* What the seabed returns, had no object stood before it. */
FUNCTION void seabed_echo(const struct fan_record *fan,
                          GLOBAL const struct ray_piece_record *pieces,
                          GLOBAL const struct object_record *objects, int strip,
                          const struct rough_ray *rough, struct rough_echo *echo,
                          struct outcome_record *outcome)
{
    const struct aspect_ray *squinted = &rough->squinted;
    const vfloat distance = rough->to_seabed * squinted->cosine;
    const vfloat straight_range = rough->ray.range_at_closest + distance;
    const struct vector3 point = along3(squinted->start, squinted->direction, rough->to_seabed);
    const struct vector3 normal = seabed_normal(fan, objects, point, squinted->direction);
    vfloat range = straight_range;
    vfloat cosine = has_relief(fan) ? -dot3(normal, squinted->direction) : -squinted->direction.z;
    mask is_open = rough->is_ray & MASK_OF(rough->to_seabed < 0.5f * FAR_AWAY);
    if (fan->source_side > 0.0f && ANY(is_open)) {
        const struct connection way =
            connect_to_source(fan, objects, &rough->ray, squinted, point, normal, distance,
                              rough->source_along, rough->source_across);
        outcome->queries += count_lanes(is_open);
        range = way.range;
        cosine = way.cosine;
        is_open = is_open & (way.is_open | rough->on_object);
    }
    vfloat weight = squinted->weight * fan->quanta;
    if (has_beam(fan)) {
        weight = weight * beam_spread(fan, squinted, straight_range);
        range = whole_range(fan, squinted, range);
    }
    const vfloat gain = refraction_gain(fan, &rough->ray, distance);
    const vfloat energy = fan->seabed_lambert * cosine * rough->strip_of_cell *
                          (rough->ray.wavefront + distance) * (gain * gain) * weight;
    const struct bin_pair bins = bins_about(
        SELECT(is_open, range * fan->bins_per_metre + fan->bin_at_reference, SPLAT(BEFORE_BINS)));
    const vfloat x = has_relief(fan) || has_beam(fan) ? point.x : rough->ray.closest.x;
    const vfloat row = fan->map_row_at_origin + x * fan->map_rows_per_metre;
    const vfloat map_range = has_relief(fan) ? range_in_plan(fan, pieces, point) : straight_range;
    const vfloat column = fan->map_column_at_reference + map_range * fan->map_columns_per_metre;
    const vint strips = has_aspects(fan) && has_relief(fan) ? track_strip_at(fan, point.x)
                                                            : SPLAT_VINT(fan->first_strip + strip);
    const vfloat kept = SELECT(is_open, energy, SPLAT(0.0f));
    const vfloat safe_row = smaller(larger(row, SPLAT(-1.0f)), SPLAT(1.0e8f));
    const vfloat safe_column = smaller(larger(column, SPLAT(-1.0f)), SPLAT(1.0e8f));
    STORE_VFLOAT(kept, echo->seabed);
    STORE_VINT(strips, echo->seabed_strip);
    STORE_VINT(bins.bin, echo->seabed_bin);
    STORE_VFLOAT(bins.later, echo->seabed_later);
    STORE_VFLOAT(safe_row, echo->row);
    STORE_VFLOAT(safe_column, echo->column);
}

/* What the objects return. */
FUNCTION void target_echo(const struct fan_record *fan, GLOBAL const struct object_record *objects,
                          int strip, const struct rough_ray *rough, struct rough_echo *echo,
                          struct outcome_record *outcome)
{
    const struct aspect_ray *squinted = &rough->squinted;
    const mask on_object = rough->on_object;
    const vfloat to_target = SELECT(on_object, rough->nearest.distance, SPLAT(0.0f));
    const vfloat target_distance = to_target * squinted->cosine;
    vfloat range = rough->ray.range_at_closest + target_distance;
    const vfloat gain = refraction_gain(fan, &rough->ray, target_distance);
    vfloat weight = squinted->weight * fan->quanta;
    if (has_beam(fan))
        weight = weight * beam_spread(fan, squinted, range);
    const vfloat area =
        rough->strip_of_cell * (rough->ray.wavefront + target_distance) * (gain * gain) * weight;
    vfloat energy = SPLAT(0.0f);
    const int objects_end = ANY(on_object) ? fan->objects : 0;
    for (int i = surface_after(-1, objects_end, rough->nearest.object, on_object); i < objects_end;
         i = surface_after(i, objects_end, rough->nearest.object, on_object)) {
        const mask here = on_object & MASK_OF(rough->nearest.object == i);
        if (!ANY(here))
            continue;
        const vfloat distance = SELECT(here, rough->nearest.distance, SPLAT(0.0f));
        const struct surface_face face = object_face(
            &objects[i], FACE_OF_SCATTERING, squinted->start, squinted->direction, distance);
        const struct vector3 back = reversed3(squinted->direction);
        struct vector3 out = back;
        mask is_open = here;
        if (fan->source_side > 0.0f) {
            const struct connection way = connect_to_source(
                fan, objects, &rough->ray, squinted,
                lifted_point(along3(squinted->start, squinted->direction, distance), &face),
                face.normal, distance * squinted->cosine, rough->source_along,
                rough->source_across);
            outcome->queries += count_lanes(here);
            is_open = is_open & way.is_open;
            out = way.direction;
            range = SELECT(here, way.range, range);
        }
        energy = SELECT(is_open,
                        rough_scattering(&objects[i].surface, face.normal, back, out) *
                            dot3(face.normal, out) * area,
                        energy);
    }
    if (has_beam(fan))
        range = whole_range(fan, squinted, range);
    const struct bin_pair bins = bins_about(range * fan->bins_per_metre + fan->bin_at_reference);
    const vint strips =
        has_aspects(fan)
            ? track_strip_at(fan, squinted->start.x + squinted->direction.x * to_target)
            : SPLAT_VINT(fan->first_strip + strip);
    STORE_VFLOAT(energy, echo->target);
    STORE_VINT(strips, echo->target_strip);
    STORE_VINT(bins.bin, echo->target_bin);
    STORE_VFLOAT(bins.later, echo->target_later);
    const vint objects_met = SELECT(on_object, rough->nearest.object, VINT_OF(SPLAT(-1.0f)));
    STORE_VINT(objects_met, echo->object);
}

/* Traces one group of WIDTH rays of a strip. */
FUNCTION void trace_rough_group(const struct fan_record *fan,
                                GLOBAL const struct ray_piece_record *pieces,
                                GLOBAL const struct object_record *objects, int strip,
                                struct random_key key, RECORD_WORD first_ray,
                                struct rough_echo *echo, struct outcome_record *outcome)
{
    vfloat chance;
    const struct rough_ray rough = rough_ray_at(fan, pieces, objects, strip, key,
                                                SPLAT_WORD(first_ray) + LANE_NUMBERS, &chance);
    seabed_echo(fan, pieces, objects, strip, &rough, echo, outcome);
    target_echo(fan, objects, strip, &rough, echo, outcome);
    STORE_VFLOAT(chance, echo->chance);
}

/* Traces the share `segment` of a strip's fan. */
FUNCTION struct outcome_record trace_rough_strip(const struct fan_record *fan,
                                                 GLOBAL const struct ray_piece_record *pieces,
                                                 GLOBAL const struct object_record *objects,
                                                 GLOBAL const float *map, GLOBAL TALLY *seabed,
                                                 GLOBAL TALLY *tiles, int strip, int segment)
{
    struct outcome_record outcome = {0, 0, 0, 0};
    const struct random_key key = key_of_strip(fan, strip);
    const struct rough_tallies tallies = rough_tallies_of(fan, strip, seabed, tiles);
    const RECORD_WORD step = (RECORD_WORD)fan->segments * WIDTH;
    for (RECORD_WORD ray = (RECORD_WORD)segment * WIDTH; ray < fan->rays; ray += step) {
        struct rough_echo echo;
        outcome.rays += rays_from(fan, ray, WIDTH);
        trace_rough_group(fan, pieces, objects, strip, key, ray, &echo, &outcome);
        for (int lane = 0; lane < WIDTH; lane++)
            tally_rough_echo(fan, objects, map, &tallies, &echo, lane, &outcome);
    }
    /* strips that another chunk's launch traces for itself are not counted here */
    outcome.rays = tallies.has_objects ? outcome.rays : 0;
    outcome.queries = tallies.has_objects ? outcome.queries + outcome.rays : 0;
    return outcome;
}

#endif
