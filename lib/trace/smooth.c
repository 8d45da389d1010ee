#include "trace/smooth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cl/launch.h"

#define STRIP_WAVELENGTHS  0.25  /* widest sub-strip: wider ones alias glints (physics.md 2) */
#define CELL_WAVELENGTHS   0.125 /* spacing of rays on the wavefront */
#define BINS_PER_DEVIATION 16.0  /* linear sharing between bins then errs by 5e-4 */

static void lay_grid(struct smooth_trace *trace, const struct tracer *tracer, uint32_t number)
{
    static const double along[3] = {1.0, 0.0, 0.0};
    const struct patch_view *view = &tracer->view;
    const struct placement *placement = &tracer->placements[number];
    const uint32_t shape = tracer->scene->objects[number].shape;
    trace->grid.strips_per_row =
        (uint32_t)ceil(view->row_spacing_m / (STRIP_WAVELENGTHS * view->wavelength_m) - 1e-9);
    trace->grid.bins_per_pixel = (uint32_t)ceil(
        BINS_PER_DEVIATION * view->column_spacing_m / tracer->response.range_deviation_m - 1e-9);
    const double extent = placement_half_extent(placement, shape, along);
    const double per_row = trace->grid.strips_per_row;
    trace->grid.strips.first =
        (int32_t)floor((view_row_of_x(view, placement->centre[0] - extent) + 0.5) * per_row) - 1;
    trace->grid.strips.count =
        (int32_t)floor((view_row_of_x(view, placement->centre[0] + extent) + 0.5) * per_row) + 2 -
        trace->grid.strips.first;
    const double range = placement_range(placement, view);
    /* along the line of sight, and what a wavefront's curvature adds at the bounding sphere's edge
     */
    const double sight[3] = {0.0, placement->centre[1] / range,
                             (placement->centre[2] - view->altitude_m) / range};
    const double bound = placement->bounding_radius_m;
    const double reach =
        1.01 * placement_half_extent(placement, shape, sight) + bound * bound / (range - bound);
    const double per_metre = trace->grid.bins_per_pixel / view->column_spacing_m;
    const double first = ((range - reach) * view->range_ratio - view->first_range_m) * per_metre;
    const double last = ((range + reach) * view->range_ratio - view->first_range_m) * per_metre;
    trace->grid.bins.first = (int32_t)floor(first) - 1;
    trace->grid.bins.count = (int32_t)ceil(last) + 2 - trace->grid.bins.first;
}

static void lay_fan(struct smooth_trace *trace, const struct tracer *tracer, uint32_t number)
{
    const struct placement *placement = &tracer->placements[number];
    const double range = trace->fan.reference_range;
    const double across[3] = {0.0, trace->fan.sine_depression, trace->fan.cosine_depression};
    const double extent =
        1.02 * placement_half_extent(placement, tracer->scene->objects[number].shape, across);
    const double cell =
        CELL_WAVELENGTHS * tracer->view.wavelength_m / sqrt(tracer->scene->injection.ray_scale);
    const double edge = asin(fmin(1.0, extent / (range - placement->bounding_radius_m)));
    const double rays = ceil(2.0 * edge * range / cell) + 1.0;
    trace->fan.rays = (uint32_t)rays;
    trace->fan.first_elevation = (float)-edge;
    trace->fan.elevation_step = (float)(2.0 * edge / rays);
    trace->fan.strata = (uint32_t)ceil(trace->fan.strip_width / cell - 1e-6);
    trace->fan.only_object = (int32_t)number;
    trace->fan.stream = STREAM_SMOOTH_RAYS + number;
}

static void choose_quanta(struct smooth_trace *trace, const struct tracer *tracer)
{
    const double ratio = tracer->view.range_ratio;
    const double cell = (double)trace->fan.strip_width / trace->fan.strata *
                        trace->fan.elevation_step * 2.0 * trace->fan.reference_range;
    const double most = cell * trace->fan.inverse_wavelength;
    trace->fan.quanta = power_of_two_below(ldexp(1.0, 36) / most);
    trace->amplitude_of_quantum = ratio * ratio / trace->fan.quanta;
}

sonject_status smooth_trace_begin(struct smooth_trace *trace, struct tracer *tracer,
                                  uint32_t number)
{
    memset(trace, 0, sizeof *trace);
    if (tracer->scene->objects[number].material.reflection == 0.0)
        return SONJECT_OK;
    struct object_record *records = allocate_array(tracer->scene->object_count, sizeof *records);
    if (!records)
        return report_out_of_memory(tracer->report, "objects");
    /* the frame is centred on the object: phases then keep their digits */
    const double *origin = tracer->placements[number].centre;
    lay_grid(trace, tracer, number);
    fan_record_init(&trace->fan, tracer, origin, &trace->grid);
    object_records_init(records, tracer, origin);
    lay_fan(trace, tracer, number);
    choose_quanta(trace, tracer);
    const sonject_status status =
        trace_device_init(&trace->on_device, tracer, PROGRAM_TRACE_SMOOTH, "trace_smooth", records,
                          (size_t)trace->grid.strips.count, 2 * (size_t)trace->grid.bins.count);
    free(records);
    return status;
}

void smooth_trace_end(struct smooth_trace *trace)
{
    trace_device_clear(&trace->on_device);
}

int32_t smooth_trace_chunk(const struct smooth_trace *trace)
{
    return (int32_t)trace->on_device.tally_strips;
}

sonject_status smooth_trace_strips(struct smooth_trace *trace, struct tracer *tracer,
                                   struct span strips, float *real_part, float *imaginary_part)
{
    const size_t count = (size_t)strips.count * (size_t)trace->grid.bins.count;
    const cl_mem buffers[] = {trace->on_device.objects, trace->on_device.tallies};
    trace->fan.first_strip = strips.first;
    trace->fan.strips = strips.count;
    const void *mapped;
    sonject_status status = buffer_clear(tracer->report, tracer->device, trace->on_device.tallies,
                                         2 * count * sizeof(int64_t));
    if (status == SONJECT_OK)
        status = trace_launch(tracer, trace->on_device.kernel, &trace->fan, buffers, 2);
    if (status == SONJECT_OK)
        status = buffer_map(tracer->report, tracer->device, trace->on_device.tallies,
                            2 * count * sizeof(int64_t), &mapped);
    if (status != SONJECT_OK)
        return status;
    const int64_t *tallies = mapped;
    for (size_t i = 0; i < count; i++) {
        real_part[i] = (float)((double)tallies[2 * i] * trace->amplitude_of_quantum);
        imaginary_part[i] = (float)((double)tallies[2 * i + 1] * trace->amplitude_of_quantum);
    }
    buffer_unmap(tracer->device, trace->on_device.tallies, mapped);
    return SONJECT_OK;
}
