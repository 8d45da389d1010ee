#include "trace/rough.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "device/device.h"
#include "trace/checkpoint.h"
#include "trace/corners.h"
#include "trace/fan.h"
#include "trace/image_sources.h"
#include "trace/object_buffer.h"

#define RAYS_PER_BIN 1.0

#define RAYS_PER_BIN_OF_BEAM                                                                       \
    3.0 /* a pixel is one ping's alone, and a beam's rays weigh unequally */

static double bin_of_processor_range(const struct rough_trace *trace, const struct tracer *tracer,
                                     double range)
{
    return view_column_of_range(&tracer->view, range) * trace->grid.bins_per_pixel;
}

static bool has_beam(const struct rough_trace *trace)
{
    return trace->fan.beam.reach > 0.0f;
}

/* Ranges, m, from a part's nearest point to where the ray over its top meets the seabed. */
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
        fmax(water_way_range(&tracer->view.water, shadow_end, lowest),
             placement_range(placement, &tracer->view) + placement->bounding_radius_m);
    const double slack =
        0.01 * placement->bounding_radius_m + tracer->scene->sonar.transducer_side_m;
    const struct part_ranges ranges = {first_range - slack, last_range + slack};
    return ranges;
}

/* Bins where a part's echoes and shadow can lie, those by way of mirrors too. */
static struct span part_bins(const struct rough_trace *trace, const struct tracer *tracer,
                             uint32_t number)
{
    const struct part_ranges ranges = ranges_of_part(tracer, &tracer->placements[number]);
    const double ratio = tracer->view.range_ratio;
    const double first = floor(bin_of_processor_range(trace, tracer, ranges.first * ratio)) - 2.0;
    const struct span mirrored = mirrored_bins(tracer, number, &trace->grid);
    /* a beam sees what is off broadside farther away */
    const double sine = has_beam(trace) ? beam_largest_sine(tracer) : 0.0;
    const double farthest = ranges.last / sqrt(1.0 - sine * sine);
    const double last = fmax(ceil(bin_of_processor_range(trace, tracer, farthest * ratio)) + 2.0,
                             mirrored.first + mirrored.count);
    const double limit = trace->grid.bins.first + trace->grid.bins.count;
    struct span bins;
    bins.first = (int32_t)fmin(fmax(first, trace->grid.bins.first), limit);
    bins.count = (int32_t)fmax(0.0, fmin(last + 1.0, limit) - bins.first);
    return span_overlap(span_join(bins, corner_bins(tracer, number, &trace->grid)),
                        trace->grid.bins);
}

/* How far, m along the track, a part's shadow and the strips of rays that meet it reach beyond it:
 * rays belong where they meet the seabed, or the patch's end. */
static double part_slide(const struct rough_trace *trace, const struct tracer *tracer,
                         const struct placement *placement)
{
    const struct part_ranges ranges = ranges_of_part(tracer, placement);
    const double sine = has_beam(trace) ? beam_largest_sine(tracer) : 0.0;
    if (has_beam(trace)) /* rays belong to the ping that they leave from */
        return ranges.last * sine / sqrt(1.0 - sine * sine);
    const double patch_end =
        line_grid_far_end(&trace->grid, &tracer->view) / tracer->view.range_ratio;
    return aspects_slide(tracer, fmax(fmin(ranges.last, patch_end) - ranges.first, 0.0));
}

/* Strips where a part's echoes and shadow can lie, in the patch and beyond. */
static struct span part_strips(const struct rough_trace *trace, const struct tracer *tracer,
                               uint32_t number)
{
    static const double along[3] = {1.0, 0.0, 0.0};
    const struct placement *placement = &tracer->placements[number];
    const double extent = placement_half_extent(placement, along) +
                          tracer->scene->sonar.transducer_side_m +
                          part_slide(trace, tracer, placement);
    const double per_row = trace->grid.strips_per_row;
    const double first =
        floor((view_row_of_x(&tracer->view, placement->centre[0] - extent) + 0.5) * per_row) - 1.0;
    const double last =
        floor((view_row_of_x(&tracer->view, placement->centre[0] + extent) + 0.5) * per_row) + 1.0;
    struct span strips;
    strips.first = (int32_t)first;
    strips.count = (int32_t)(last + 1.0 - first);
    return strips;
}

/* Strips beyond the patch's ends from which rays come to parts in it. */
static int32_t object_halo(const struct rough_trace *trace, const struct tracer *tracer)
{
    const struct span patch = trace->grid.strips;
    int32_t halo = 0;
    if (!(aspects_sine(tracer) > 0.0))
        return 0;
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct span strips = part_strips(trace, tracer, i);
        const int32_t before = patch.first - strips.first;
        const int32_t after = strips.first + strips.count - (patch.first + patch.count);
        halo = before > halo ? before : halo;
        halo = after > halo ? after : halo;
    }
    return halo;
}

/* Tells the record of a part of an object where the object's tile is. */
static void rough_tile_describe(const struct rough_trace *trace, uint32_t object,
                                struct object_record *record)
{
    const struct rough_tile *tile = &trace->tiles[object];
    record->tile_offset = (uint32_t)tile->offset;
    record->tile_first_strip = tile->grid.strips.first;
    record->tile_strips = tile->grid.strips.count;
    record->tile_first_bin = tile->grid.bins.first - trace->grid.bins.first;
    record->tile_bins = tile->grid.bins.count;
}

static sonject_status init_tiles(struct rough_trace *trace, struct tracer *tracer,
                                 struct object_record *records)
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
            tile->grid.strips =
                span_join(tile->grid.strips,
                          span_overlap(part_strips(trace, tracer, part), trace->grid.strips));
            tile->grid.bins = span_join(tile->grid.bins, part_bins(trace, tracer, part));
        }
        for (uint32_t k = 0; k < object->part_count; k++)
            rough_tile_describe(trace, i, &records[object->first_part + k]);
        elements += line_grid_cells(&tile->grid) * TILE_PLANES;
        if (elements > (size_t)1 << 31)
            return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                                  "objects and shadows cover too many pixels: use a smaller patch");
    }
    trace->tile_elements = elements;
    return SONJECT_OK;
}

/* Quanta so fine that the weakest seabed still counts in millions, and so coarse that the
 * brightest surface (an object's, or the map's brightest seabed) stays below the limit. */
static void choose_quanta(struct rough_trace *trace, const struct tracer *tracer, const float *map)
{
    double brightest = 1.0;
    if (map)
        for (size_t i = 0; i < tracer->view.rows * tracer->view.columns; i++)
            brightest = fmax(brightest, map[i]);
    const double wavefront = (double)trace->fan.strip_width * trace->fan.elevation_step * 2.0 *
                             trace->fan.reference_range;
    const double beam = has_beam(trace) ? beam_largest_weight(tracer, &trace->fan) : 1.0;
    const double most =
        beam * wavefront *
        fmax(brightest_scattering(tracer), tracer->scene->seabed.lambert * brightest);
    trace->fan.quanta = power_of_two_below(ldexp(1.0, 44) / most);
    trace->energy_of_quantum = view_energy_scale(&tracer->view) / trace->fan.quanta;
}

static sonject_status make_buffers(struct rough_trace *trace, struct tracer *tracer,
                                   struct object_record *records, const float *map)
{
    const size_t map_bytes = map ? tracer->view.rows * tracer->view.columns * sizeof *map : 0;
    sonject_status status =
        trace_device_init(&trace->on_device, tracer, PROGRAM_TRACE_ROUGH, "trace_rough", records,
                          (struct part_list){NULL, tracer->part_count},
                          (size_t)trace->grid.strips.count, (size_t)trace->grid.bins.count);
    THEN(status, buffer_create(tracer->report, tracer->device, map_bytes, map, &trace->map));
    THEN(status, buffer_create(tracer->report, tracer->device,
                               trace->tile_elements * sizeof(int64_t), NULL, &trace->tile_buffer));
    return status;
}

/* Strips of a fan, or a beam's rays on a grid of one strip a ping. */
static sonject_status init_fan(struct rough_trace *trace, struct tracer *tracer, bool has_map,
                               bool is_beam)
{
    const double rays_per_bin = is_beam ? RAYS_PER_BIN_OF_BEAM : RAYS_PER_BIN;
    sonject_status status =
        patch_fan_init(&trace->fan, tracer, &trace->grid, has_map, rays_per_bin);
    if (status == SONJECT_OK && is_beam)
        status = beam_record_init(&trace->fan, tracer, &trace->grid);
    THEN(status, patch_rays_init(&trace->rays, &trace->fan.table, tracer, &trace->grid));
    trace->fan.stream = STREAM_ROUGH_RAYS;
    aspects_record_init(&trace->fan, tracer, &trace->grid);
    trace->fan.seabed_lambert = (float)tracer->scene->seabed.lambert;
    return status;
}

/* As dense as the fan that goes straight to the objects. */
static void aim_at_part(struct fan_record *fan, const struct rough_trace *trace,
                        const struct tracer *tracer, uint32_t part, const struct water_way *way)
{
    const struct placement *placement = &tracer->placements[part];
    const struct elevations edges = elevations_of_object(tracer, part, way);
    const double radius =
        water_way_ray(way, water_way_grazing(way, placement->centre[1], placement->centre[2]),
                      placement->centre[2])
            .wavefront_m;
    const double bin =
        tracer->view.column_spacing_m / trace->grid.bins_per_pixel / tracer->view.range_ratio;
    const double step = bin / radius / (RAYS_PER_BIN * tracer->scene->injection.ray_scale);
    const double rays = ceil((edges.highest - edges.lowest) / step) + 1.0;
    fan->rays = (uint32_t)rays;
    fan->first_elevation = (float)edges.lowest;
    fan->elevation_step = (float)((edges.highest - edges.lowest) / rays);
}

static sonject_status begin(struct rough_trace *trace, struct tracer *tracer, const float *map,
                            const struct point_response *response, bool is_beam)
{
    memset(trace, 0, sizeof *trace);
    const struct patch_view *view = &tracer->view;
    line_grid_for_patch(&trace->grid, view, response);
    double origin[3];
    patch_fan_origin(origin, view);
    struct object_record *records = allocate_array(tracer->part_count, sizeof *records);
    CHECK_MEMORY(tracer->report, records, "objects");
    object_records_init(records, tracer, origin);
    sonject_status status = init_fan(trace, tracer, map != NULL, is_beam);
    trace->relief_halo = aspects_relief_halo(tracer, &trace->grid);
    trace->object_halo = object_halo(trace, tracer);
    rough_trace_aim(trace, trace->grid.strips);
    THEN(status, init_tiles(trace, tracer, records));
    if (status == SONJECT_OK) {
        choose_quanta(trace, tracer, map);
        status = make_buffers(trace, tracer, records, map);
    }
    free(records);
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
    trace_device_clear(&trace->on_device);
    ray_table_clear(&trace->rays);
    buffer_release(&trace->map);
    buffer_release(&trace->tile_buffer);
}

int32_t rough_trace_chunk(const struct rough_trace *trace)
{
    return (int32_t)trace->on_device.tally_strips;
}

void rough_trace_flatten(struct rough_trace *trace)
{
    trace->fan.relief_words = 0;
    trace->fan.objects = 0;
    trace->relief_halo = 0;
    trace->object_halo = 0;
}

static sonject_status read_tallies(struct tracer *tracer, device_buffer buffer, size_t count,
                                   double unit, float *values)
{
    const void *mapped;
    const int64_t *tallies;
    CHECK(buffer_map(tracer->report, tracer->device, buffer, count * sizeof(int64_t), &mapped));
    sonject_status status = checkpoint_sums(tracer->checkpoint, mapped, count, &tallies);
    for (size_t i = 0; status == SONJECT_OK && i < count; i++)
        values[i] = (float)((double)tallies[i] * unit);
    buffer_unmap(tracer->device, buffer, mapped);
    return status;
}

void rough_trace_aim(struct rough_trace *trace, struct span strips)
{
    struct fan_record *fan = &trace->fan;
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
    const device_buffer buffers[] = {trace->on_device.objects, trace->map, trace->on_device.tallies,
                                     trace->tile_buffer};
    rough_trace_aim(trace, strips);
    sonject_status status = buffer_clear(tracer->report, tracer->device, trace->on_device.tallies,
                                         count * sizeof(int64_t));
    THEN(status,
         trace_launch(tracer, trace->on_device.kernel, &trace->fan, &trace->rays, buffers, 4));
    THEN(status,
         read_tallies(tracer, trace->on_device.tallies, count, trace->energy_of_quantum, seabed));
    if (status == SONJECT_OK)
        tracer->counts.pings += (uint64_t)strips.count;
    return status;
}

sonject_status rough_trace_tiles(struct rough_trace *trace, struct tracer *tracer, float *tiles)
{
    CHECK(read_tallies(tracer, trace->tile_buffer, trace->tile_elements, trace->energy_of_quantum,
                       tiles));
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
                                 const struct trace_device *on_device,
                                 const struct launch_parts *parts, const struct image_pair *pair)
{
    const uint32_t part = parts->numbers[parts->target];
    const struct rough_tile *tile = &trace->tiles[tracer->placements[part].object];
    struct image_pair_record record;
    struct fan_record fan;
    device_buffer sources = NULL;
    struct ray_table rays = {NULL, 0};
    sonject_status status = image_pair_aim(&fan, &record, &rays, tracer, part, pair, &trace->grid);
    aim_at_part(&fan, trace, tracer, part, &pair->outgoing->way);
    fan.objects = (int32_t)parts->count;
    fan.relief_words = object_buffer_relief_words(tracer, parts->count);
    fan.only_object = (int32_t)parts->target;
    fan.stream = STREAM_MIRRORED_ROUGH_RAYS + STREAMS_OF_PAIR * pair->number + part;
    fan.quanta = trace->fan.quanta;
    fan.first_strip = tile->grid.strips.first;
    fan.strips = tile->grid.strips.count;
    THEN(status, buffer_create(tracer->report, tracer->device, sizeof record, &record, &sources));
    const device_buffer buffers[] = {on_device->objects, trace->tile_buffer, sources};
    THEN(status, trace_launch(tracer, on_device->kernel, &fan, &rays, buffers, 3));
    ray_table_clear(&rays);
    buffer_release(&sources);
    return status;
}

static sonject_status trace_pairs(struct rough_trace *trace, struct tracer *tracer,
                                  const struct trace_device *on_device,
                                  const struct launch_parts *parts)
{
    const uint32_t part = parts->numbers[parts->target];
    struct image_pairs pairs;
    struct image_pair pair;
    sonject_status status = SONJECT_OK;
    image_pairs_begin(&pairs, tracer, part);
    while (status == SONJECT_OK && image_pairs_next(&pairs, &pair))
        if (image_pair_bins_in_patch(tracer, part, &pair, &trace->grid).count > 0)
            status = trace_pair(trace, tracer, on_device, parts, &pair);
    return status;
}

static sonject_status trace_part(struct rough_trace *trace, struct tracer *tracer, uint32_t part)
{
    const uint32_t object = tracer->placements[part].object;
    struct trace_device on_device;
    struct launch_parts parts;
    struct object_record *records = NULL;
    memset(&on_device, 0, sizeof on_device);
    sonject_status status =
        launch_parts_init(&parts, tracer, part, &trace->tiles[object].grid, false);
    THEN(status, launch_records_create(&records, tracer, &parts, tracer->placements[part].centre));
    if (status == SONJECT_OK) {
        rough_tile_describe(trace, object, &records[parts.target]);
        status = trace_device_init(&on_device, tracer, PROGRAM_TRACE_ROUGH_MIRRORED,
                                   "trace_rough_mirrored", records,
                                   (struct part_list){parts.numbers, parts.count}, 1, 1);
    }
    THEN(status, trace_pairs(trace, tracer, &on_device, &parts));
    trace_device_clear(&on_device);
    free(records);
    launch_parts_clear(&parts);
    return status;
}

sonject_status rough_trace_mirrored(struct rough_trace *trace, struct tracer *tracer)
{
    sonject_status status = SONJECT_OK;
    for (uint32_t i = 0; status == SONJECT_OK && i < tracer->part_count; i++)
        if (material_is_rough(tracer->placements[i].material) &&
            line_grid_cells(&trace->tiles[tracer->placements[i].object].grid) > 0 &&
            mirrored_bins(tracer, i, &trace->grid).count > 0)
            status = trace_part(trace, tracer, i);
    return status;
}
