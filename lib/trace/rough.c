#include "trace/rough.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "trace/fan.h"
#include "trace/fouling.h"
#include "trace/multibounce.h"
#include "trace/object_buffer.h"

#define PI           3.14159265358979323846
#define RAYS_PER_BIN 1.0

/* A pixel belongs to one ping alone, and a beam's rays weigh unequally. */
#define RAYS_PER_BIN_OF_BEAM 3.0

static bool has_beam(const struct rough_trace *trace)
{
    return trace->launch.fan.beam.reach > 0.0f;
}

/* Ranges, m, from a part's nearest point to the seabed met by the ray over its top. */
struct part_ranges {
    double first, last;
};

static struct part_ranges ranges_of_part(const struct tracer *tracer,
                                         const struct placement *placement)
{
    const double lowest = tracer_lowest_seabed(tracer);
    const double shadow_end = placement_shadow_end(placement, &tracer->view, lowest);
    const double first_range =
        placement_range(placement, &tracer->view) - placement->bounding_radius_m;
    const double last_range =
        fmax(ray_path_range(&tracer->view.water, shadow_end, lowest),
             placement_range(placement, &tracer->view) + placement->bounding_radius_m);
    const double slack =
        0.01 * placement->bounding_radius_m + tracer->scene->sonar.transducer_side_m;
    const struct part_ranges ranges = {first_range - slack, last_range + slack};
    return ranges;
}

struct span rough_bins_of_part(const struct tracer *tracer, uint32_t number,
                               const struct line_grid *grid, bool by_beam)
{
    const struct part_ranges ranges = ranges_of_part(tracer, &tracer->placements[number]);
    const double ratio = tracer->view.range_ratio;
    const struct span images = image_source_bins(tracer, number, grid);
    /* a beam sees farther away what is off broadside */
    const double sine = by_beam ? beam_largest_sine(tracer) : 0.0;
    const double farthest = ranges.last / sqrt(1.0 - sine * sine);
    const double first_column = view_column_of_range(&tracer->view, ranges.first * ratio);
    const double last_column = view_column_of_range(&tracer->view, farthest * ratio);
    const double first = floor(first_column * grid->bins_per_pixel) - 2.0;
    const double last =
        fmax(ceil(last_column * grid->bins_per_pixel) + 2.0, images.first + images.count);
    const double limit = grid->bins.first + grid->bins.count;
    struct span bins;
    bins.first = (int32_t)fmin(fmax(first, grid->bins.first), limit);
    bins.count = (int32_t)fmax(0.0, fmin(last + 1.0, limit) - bins.first);
    return span_overlap(span_join(bins, multibounce_bins(tracer, number, grid, true)), grid->bins);
}

/* Returns how far, m along the track, a part's shadow and the strips of rays that meet it reach
 * beyond it. Rays belong where they meet the seabed, or the patch's end. */
static double part_slide(const struct tracer *tracer, const struct placement *placement,
                         const struct line_grid *grid, bool by_beam)
{
    const struct part_ranges ranges = ranges_of_part(tracer, placement);
    const double sine = by_beam ? beam_largest_sine(tracer) : 0.0;
    if (by_beam) /* rays belong to the ping that they leave from */
        return ranges.last * sine / sqrt(1.0 - sine * sine);
    const double patch_end = line_grid_far_end(grid, &tracer->view) / tracer->view.range_ratio;
    return aspects_slide(tracer, fmax(fmin(ranges.last, patch_end) - ranges.first, 0.0));
}

struct span rough_strips_of_part(const struct tracer *tracer, uint32_t number,
                                 const struct line_grid *grid, bool by_beam)
{
    static const double along[3] = {1.0, 0.0, 0.0};
    const struct placement *placement = &tracer->placements[number];
    const double extent = placement_half_extent(placement, along) +
                          tracer->scene->sonar.transducer_side_m +
                          part_slide(tracer, placement, grid, by_beam);
    return strips_between(tracer, grid, placement->centre[0] - extent,
                          placement->centre[0] + extent);
}

/* Returns the strips beyond the patch's ends from which rays come to parts in it. */
static int32_t object_halo(const struct rough_trace *trace, const struct tracer *tracer)
{
    const struct span patch = trace->grid.strips;
    int32_t halo = 0;
    if (!(aspects_sine(tracer) > 0.0))
        return 0;
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        if (!tracer_follows(tracer, tracer->placements[i].object))
            continue;
        const struct span strips = rough_strips_of_part(tracer, i, &trace->grid, has_beam(trace));
        const int32_t before = patch.first - strips.first;
        const int32_t after = strips.first + strips.count - (patch.first + patch.count);
        halo = before > halo ? before : halo;
        halo = after > halo ? after : halo;
    }
    return halo;
}

void rough_tile_describe(const struct rough_trace *trace, uint32_t object,
                         struct object_record *record)
{
    const struct rough_tile *tile = &trace->tiles[object];
    record->tile_offset = (uint32_t)tile->offset;
    record->tile_first_strip = tile->grid.strips.first;
    record->tile_strips = tile->grid.strips.count;
    record->tile_first_bin = tile->grid.bins.first - trace->grid.bins.first;
    record->tile_bins = tile->grid.bins.count;
}

static sonject_status init_tiles(struct rough_trace *trace, struct tracer *tracer)
{
    size_t elements = 0;
    for (uint32_t i = 0; i < tracer->scene->object_count; i++) {
        const struct placed_object *object = &tracer->objects[i];
        struct rough_tile *tile = &trace->tiles[i];
        tile->grid = trace->grid;
        tile->grid.strips.count = 0;
        tile->grid.bins.count = 0;
        tile->offset = elements;
        for (uint32_t k = 0; k < object->part_count; k++) {
            const uint32_t part = object->first_part + k;
            const struct span strips =
                rough_strips_of_part(tracer, part, &trace->grid, has_beam(trace));
            tile->grid.strips =
                span_join(tile->grid.strips, span_overlap(strips, trace->grid.strips));
            tile->grid.bins = span_join(
                tile->grid.bins, rough_bins_of_part(tracer, part, &trace->grid, has_beam(trace)));
        }
        elements += line_grid_cells(&tile->grid) * TILE_PLANES;
        if (elements > (size_t)1 << 31)
            return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                                  "objects and shadows cover too many pixels: use a smaller patch");
    }
    trace->tile_elements = elements;
    return SONJECT_OK;
}

/* Chooses quanta so fine that the weakest seabed counts in millions. They are so coarse that the
 * brightest surface stays below the limit: an object's, at least Lambert's 1/pi, or the map's
 * brightest seabed. */
static void choose_quanta(struct rough_trace *trace, const struct tracer *tracer, const float *map)
{
    struct fan_record *fan = &trace->launch.fan;
    double seabed = 1.0;
    if (map)
        for (size_t i = 0; i < tracer->view.rows * tracer->view.columns; i++)
            seabed = fmax(seabed, map[i]);
    double brightest = 1.0 / PI;
    for (uint32_t i = 0; i < tracer->part_count; i++)
        brightest = fmax(brightest, material_brightness(&tracer->placements[i].material) *
                                        fouling_brightest(tracer, i));
    const double wavefront =
        (double)fan->strip_width * fan->elevation_step * 2.0 * fan->reference_range;
    const double beam = has_beam(trace) ? beam_largest_weight(tracer, fan) : 1.0;
    const double most = beam * wavefront * fmax(brightest, tracer->view.seabed_lambert * seabed);
    fan->quanta = power_of_two_below(ldexp(1.0, 44) / most);
    trace->energy_of_quantum = view_energy_scale(&tracer->view) / fan->quanta;
}

static sonject_status begin_launch(struct rough_trace *trace, struct tracer *tracer,
                                   const float *map)
{
    const size_t map_bytes = map ? tracer->view.rows * tracer->view.columns * sizeof *map : 0;
    const struct part_list parts = all_parts(tracer);
    struct launch *launch = &trace->launch;
    double origin[3];
    patch_fan_origin(origin, &tracer->view);
    sonject_status status = launch_begin(launch, tracer, PROGRAM_TRACE_ROUGH, "trace_rough");
    THEN(status, launch_add_objects(launch, tracer, &parts, origin, trace));
    THEN(status, launch_add(launch, tracer, LAUNCH_MAP, map_bytes, map));
    THEN(status, launch_add(launch, tracer, LAUNCH_EDGES, trace->edges.count * sizeof(float),
                            trace->edges.elevations));
    THEN(status, launch_add_tallies(launch, tracer, trace->grid.strips.count,
                                    (size_t)trace->grid.bins.count, &trace->chunk));
    THEN(status,
         launch_add(launch, tracer, LAUNCH_TILES, trace->tile_elements * sizeof(int64_t), NULL));
    return status;
}

/* Lays the rays of a fan, or of a beam on a grid of one strip a ping. */
static sonject_status init_fan(struct rough_trace *trace, struct tracer *tracer, bool has_map,
                               bool is_beam)
{
    const double rays_per_bin = is_beam ? RAYS_PER_BIN_OF_BEAM : RAYS_PER_BIN;
    const double nearest = is_beam ? beam_nearest(tracer, &trace->grid)
                                   : line_grid_near_end(&trace->grid, &tracer->view);
    struct fan_record *fan = &trace->launch.fan;
    patch_fan_aim(fan, tracer, &trace->grid, has_map);
    if (is_beam)
        beam_record_init(fan, tracer);
    /* the table tells whether there are rays over all objects */
    sonject_status status = patch_rays_init(&trace->launch.rays, &fan->table, tracer, &trace->grid);
    THEN(status, fan_edges_init(&trace->edges, fan, tracer, &trace->grid, nearest, rays_per_bin));
    trace->launch.fan.stream = STREAM_ROUGH_RAYS;
    aspects_record_init(&trace->launch.fan, tracer, &trace->grid);
    trace->launch.fan.seabed_lambert = (float)tracer->view.seabed_lambert;
    return status;
}

static sonject_status begin(struct rough_trace *trace, struct tracer *tracer, const float *map,
                            const struct point_response *response, bool is_beam)
{
    memset(trace, 0, sizeof *trace);
    line_grid_for_patch(&trace->grid, &tracer->view, response);
    sonject_status status = init_fan(trace, tracer, map != NULL, is_beam);
    trace->relief_halo = aspects_relief_halo(tracer, &trace->grid);
    trace->object_halo = object_halo(trace, tracer);
    rough_trace_aim(trace, trace->grid.strips);
    THEN(status, init_tiles(trace, tracer));
    if (status == SONJECT_OK) {
        choose_quanta(trace, tracer, map);
        status = begin_launch(trace, tracer, map);
    }
    if (status != SONJECT_OK)
        rough_trace_end(trace);
    return status;
}

sonject_status rough_trace_begin(struct rough_trace *trace, struct tracer *tracer, const float *map)
{
    return begin(trace, tracer, map, &tracer->response, false);
}

sonject_status rough_trace_begin_beam(struct rough_trace *trace, struct tracer *tracer,
                                      const struct point_response *response)
{
    return begin(trace, tracer, NULL, response, true);
}

void rough_trace_end(struct rough_trace *trace)
{
    launch_end(&trace->launch);
    free(trace->edges.elevations);
    trace->edges.elevations = NULL;
}

void rough_trace_flatten(struct rough_trace *trace)
{
    trace->launch.fan.relief_words = 0;
    trace->launch.fan.objects = 0;
    trace->relief_halo = 0;
    trace->object_halo = 0;
}

void rough_trace_aim(struct rough_trace *trace, struct span strips)
{
    struct fan_record *fan = &trace->launch.fan;
    const struct span patch = trace->grid.strips;
    const bool is_first = strips.first == patch.first;
    const bool is_last = strips.first + strips.count == patch.first + patch.count;
    const int32_t most =
        trace->relief_halo > trace->object_halo ? trace->relief_halo : trace->object_halo;
    const int32_t before = is_first ? most : trace->relief_halo;
    const int32_t after = is_last ? most : trace->relief_halo;
    fan->first_strip = strips.first - before;
    fan->strips = before + strips.count + after;
    fan->aspects.tally_first_strip = strips.first;
    fan->aspects.tally_strips = strips.count;
    /* each ray tallies objects once, whatever the chunks */
    fan->aspects.core_first_strip = is_first ? fan->first_strip : strips.first;
    fan->aspects.core_strips =
        (is_last ? fan->first_strip + fan->strips : strips.first + strips.count) -
        fan->aspects.core_first_strip;
}

sonject_status rough_trace_strips(struct rough_trace *trace, struct tracer *tracer,
                                  struct span strips, float *seabed)
{
    const size_t count = (size_t)strips.count * (size_t)trace->grid.bins.count;
    device_buffer tallies = trace->launch.buffers[LAUNCH_TALLIES];
    rough_trace_aim(trace, strips);
    CHECK(buffer_clear(tracer->report, tracer->device, tallies, count * sizeof(int64_t)));
    CHECK(launch_run(&trace->launch, tracer));
    CHECK(tallies_read(tracer, tallies, 0, count, trace->energy_of_quantum, 1, &seabed));
    tracer->counts.pings += (uint64_t)strips.count;
    return SONJECT_OK;
}

sonject_status rough_trace_tiles(struct rough_trace *trace, struct tracer *tracer, float *tiles)
{
    CHECK(tallies_read(tracer, trace->launch.buffers[LAUNCH_TILES], 0, trace->tile_elements,
                       trace->energy_of_quantum, 1, &tiles));
    for (uint32_t i = 0; i < tracer->scene->object_count; i++) {
        const struct rough_tile *tile = &trace->tiles[i];
        const size_t plane = line_grid_cells(&tile->grid);
        float *footprint = tiles + tile->offset + TILE_FOOTPRINT * plane;
        for (size_t k = 0; k < plane; k++)
            footprint[k] = (float)(footprint[k] / trace->energy_of_quantum);
    }
    return SONJECT_OK;
}

static sonject_status trace_pair(struct rough_trace *trace, struct tracer *tracer,
                                 struct launch *launch, const struct part_list *parts,
                                 const struct image_pair *pair)
{
    const uint32_t part = parts->numbers[parts->target];
    const struct rough_tile *tile = &trace->tiles[tracer->placements[part].object];
    const double bin =
        tracer->view.column_spacing_m / trace->grid.bins_per_pixel / tracer->view.range_ratio;
    struct fan_record *fan = &launch->fan;
    struct image_pair_record record;
    sonject_status status =
        image_pair_aim(fan, &record, &launch->rays, tracer, part, pair, &trace->grid);
    /* the fan is as dense as the one that goes straight to the objects */
    fan_aim_at_part(fan, tracer, part, &pair->outgoing->path,
                    bin / (RAYS_PER_BIN * tracer->scene->injection.ray_scale));
    fan_set_parts(fan, tracer, parts);
    fan->stream = STREAM_IMAGE_ROUGH_RAYS + STREAMS_OF_PAIR * pair->number + part;
    fan->quanta = trace->launch.fan.quanta;
    fan->first_strip = tile->grid.strips.first;
    fan->strips = tile->grid.strips.count;
    launch->buffers[LAUNCH_TILES] = trace->launch.buffers[LAUNCH_TILES];
    THEN(status, launch_add(launch, tracer, LAUNCH_PAIR, sizeof record, &record));
    THEN(status, launch_run(launch, tracer));
    launch->buffers[LAUNCH_TILES] = NULL; /* the tiles belong to the trace */
    buffer_release(tracer->device, &launch->buffers[LAUNCH_PAIR]);
    ray_table_clear(&launch->rays);
    return status;
}

static sonject_status trace_part(struct rough_trace *trace, struct tracer *tracer, uint32_t part)
{
    const uint32_t object = tracer->placements[part].object;
    struct launch launch;
    struct part_list parts;
    struct image_pairs pairs;
    struct image_pair pair;
    memset(&launch, 0, sizeof launch);
    sonject_status status = parts_in_way(&parts, tracer, part, &trace->tiles[object].grid, false);
    THEN(status, launch_begin(&launch, tracer, PROGRAM_TRACE_ROUGH_IMAGES, "trace_rough_images"));
    THEN(status,
         launch_add_objects(&launch, tracer, &parts, tracer->placements[part].centre, trace));
    image_pairs_begin(&pairs, tracer, part, false, 1);
    while (status == SONJECT_OK && image_pairs_next(&pairs, &pair))
        if (image_pair_bins_in_patch(tracer, part, &pair, &trace->grid).count > 0)
            status = trace_pair(trace, tracer, &launch, &parts, &pair);
    launch_end(&launch);
    part_list_clear(&parts);
    return status;
}

sonject_status rough_trace_images(struct rough_trace *trace, struct tracer *tracer)
{
    sonject_status status = SONJECT_OK;
    for (uint32_t i = 0; status == SONJECT_OK && i < tracer->part_count; i++)
        if (material_is_rough(&tracer->placements[i].material) &&
            line_grid_cells(&trace->tiles[tracer->placements[i].object].grid) > 0 &&
            image_source_bins(tracer, i, &trace->grid).count > 0)
            status = trace_part(trace, tracer, i);
    return status;
}
