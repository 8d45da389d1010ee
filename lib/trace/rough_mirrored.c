#include "trace/rough_mirrored.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cl/launch.h"
#include "trace/launch_parts.h"
#include "trace/object_buffer.h"
#include "trace/object_rays.h"
#include "trace/source_pairs.h"

#define RAYS_PER_BIN 1

/* As dense as the fan that goes straight to the objects. */
static void lay_fan(struct fan_record *fan, const struct rough_trace *trace,
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

static sonject_status trace_pair(struct rough_trace *trace, struct tracer *tracer,
                                 const struct trace_device *on_device,
                                 const struct launch_parts *parts, const struct source_pair *pair)
{
    const uint32_t part = parts->numbers[parts->target];
    const struct rough_tile *tile = &trace->tiles[tracer->placements[part].object];
    struct source_pair_record record;
    struct fan_record fan;
    cl_mem sources = NULL;
    struct ray_table rays = {NULL, 0};
    sonject_status status = source_pair_aim(&fan, &record, &rays, tracer, part, pair, &trace->grid);
    lay_fan(&fan, trace, tracer, part, &pair->outgoing->way);
    fan.objects = (int32_t)parts->count;
    fan.relief_words = object_buffer_relief_words(tracer, parts->count);
    fan.only_object = (int32_t)parts->target;
    fan.stream = STREAM_MIRRORED_ROUGH_RAYS + STREAMS_OF_PAIR * pair->number + part;
    fan.quanta = trace->fan.quanta;
    fan.first_strip = tile->grid.strips.first;
    fan.strips = tile->grid.strips.count;
    THEN(status, buffer_create(tracer->report, tracer->device, sizeof record, &record, &sources));
    const cl_mem buffers[] = {on_device->objects, trace->tile_buffer, sources};
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
    struct source_pairs pairs;
    struct source_pair pair;
    sonject_status status = SONJECT_OK;
    source_pairs_begin(&pairs, tracer, part);
    while (status == SONJECT_OK && source_pairs_next(&pairs, &pair))
        if (source_pair_bins_in_patch(tracer, part, &pair, &trace->grid).count > 0)
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
