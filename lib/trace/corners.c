#include "trace/corners.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cl/launch.h"
#include "trace/corner_reach.h"
#include "trace/smooth.h"

#define TALLY_BYTES ((size_t)128 << 20)

/* In the sub-strips of first and last hits. */
static struct span mean_strips(struct span one, struct span other)
{
    struct span mean;
    mean.first = (int32_t)floor(0.5 * ((double)one.first + other.first)) - 1;
    mean.count = (int32_t)ceil(0.5 * ((double)one.first + one.count + other.first + other.count)) +
                 2 - mean.first;
    return mean;
}

static void lay_strips(struct corners *corners, const struct tracer *tracer, uint32_t part)
{
    struct line_grid other;
    glint_strips_lay(&corners->grid, tracer, part);
    corners->first_hits = corners->last_hits = corners->grid.strips;
    for (uint32_t i = 0; i < tracer->part_count; i++)
        if (material_is_smooth(tracer->placements[i].material)) {
            glint_strips_lay(&other, tracer, i);
            corners->last_hits = span_join(corners->last_hits, other.strips);
        }
    corners->is_focused = tracer->scene->injection.column_rule == SONJECT_COLUMNS_FOCUSED;
    if (corners->is_focused)
        corners->grid.strips = mean_strips(corners->first_hits, corners->last_hits);
}

/* Paths may gather much of a wide tube in one cell, so quanta leave seven powers of ten over what a
 * plane mirror's cell brings. */
static void choose_quanta(struct corner_trace *trace, const struct tracer *tracer)
{
    const double ratio = tracer->view.range_ratio;
    const double cell = (double)trace->fan.strip_width / trace->fan.strata *
                        trace->fan.elevation_step * 2.0 * trace->fan.reference_range;
    trace->fan.quanta = power_of_two_below(ldexp(1.0, 28) / (cell * trace->fan.inverse_wavelength));
    trace->amplitude_of_quantum = ratio * ratio / trace->fan.quanta;
}

static void corner_record_init(struct corner_record *record, const struct tracer *tracer,
                               const struct source_pair *pair)
{
    const sonject_injection_params *injection = &tracer->scene->injection;
    double height;
    const sonject_material_params *seabed;
    memset(record, 0, sizeof *record);
    record->interactions =
        (int32_t)(injection->interactions - pair->outgoing->bounces - pair->returning->bounces);
    record->is_focused = injection->column_rule == SONJECT_COLUMNS_FOCUSED;
    if (scene_mirror(tracer->scene, MIRROR_SEABED, &height, &seabed))
        surface_record_init(&record->seabed, seabed, tracer->view.wavelength_m);
}

static void corner_trace_end(struct corner_trace *trace)
{
    trace_device_clear(&trace->on_device);
    ray_table_clear(&trace->rays);
    buffer_release(&trace->sources);
    buffer_release(&trace->corners);
}

static sonject_status begin_on_device(struct corner_trace *trace, struct tracer *tracer,
                                      const double origin[3],
                                      const struct source_pair_record *sources)
{
    struct object_record *records = allocate_array(tracer->part_count, sizeof *records);
    if (!records)
        return report_out_of_memory(tracer->report, "objects");
    object_records_init(records, tracer, origin);
    sonject_status status = trace_device_init(&trace->on_device, tracer, PROGRAM_TRACE_CORNERS,
                                              "trace_corners", records, 1, 1);
    free(records);
    if (status == SONJECT_OK)
        status = buffer_create(tracer->report, tracer->device, sizeof *sources, sources,
                               &trace->sources);
    if (status == SONJECT_OK)
        status = buffer_create(tracer->report, tracer->device, sizeof trace->record, &trace->record,
                               &trace->corners);
    return status;
}

static sonject_status begin_trace(struct corner_trace *trace, const struct corners *corners,
                                  struct tracer *tracer, uint32_t part,
                                  const struct source_pair *pair)
{
    struct source_pair_record sources;
    struct line_grid grid = corners->grid;
    memset(trace, 0, sizeof *trace);
    trace->bins = grid.bins = corner_pair_bins(tracer, part, pair, &grid);
    if (trace->bins.count == 0)
        return SONJECT_OK;
    corner_record_init(&trace->record, tracer, pair);
    sonject_status status =
        source_pair_aim(&trace->fan, &sources, &trace->rays, tracer, part, pair, &grid);
    trace->fan.stream = STREAM_CORNER_RAYS + STREAMS_OF_PAIR * pair->number + part;
    glint_fan_lay(&trace->fan, tracer, part, &pair->outgoing->way, corner_rays_finer(tracer, part));
    choose_quanta(trace, tracer);
    if (status == SONJECT_OK)
        status = begin_on_device(trace, tracer, tracer->placements[part].centre, &sources);
    if (status != SONJECT_OK)
        corner_trace_end(trace);
    return status;
}

static sonject_status begin_pairs(struct corners *corners, struct tracer *tracer, uint32_t part)
{
    struct corner_pairs pairs;
    const struct source_pair *pair;
    sonject_status status = SONJECT_OK;
    corner_pairs_begin(&pairs, tracer, part);
    while (status == SONJECT_OK && (pair = corner_pairs_next(&pairs)) != NULL) {
        struct corner_trace *trace = &corners->traces[corners->count];
        status = begin_trace(trace, corners, tracer, part, pair);
        if (status != SONJECT_OK)
            break;
        corners->grid.bins = span_join(corners->grid.bins, trace->bins);
        corners->count += trace->bins.count > 0;
    }
    return status;
}

static sonject_status make_tallies(struct corners *corners, struct tracer *tracer)
{
    size_t bins = 1;
    for (size_t i = 0; i < corners->count; i++)
        if ((size_t)corners->traces[i].bins.count > bins)
            bins = (size_t)corners->traces[i].bins.count;
    const size_t line_bytes = 2 * bins * sizeof(int64_t);
    const size_t limit = tracer->device->allocation_limit;
    const size_t fitting = (limit < TALLY_BYTES ? limit : TALLY_BYTES) / line_bytes;
    const size_t strips = (size_t)corners->grid.strips.count;
    corners->chunk = (int32_t)(fitting < 1 ? 1 : fitting < strips ? fitting : strips);
    corners->real_part = allocate_array((size_t)corners->chunk * bins, sizeof(float));
    corners->imaginary_part = allocate_array((size_t)corners->chunk * bins, sizeof(float));
    if (!corners->real_part || !corners->imaginary_part)
        return report_out_of_memory(tracer->report, "echoes of corners");
    return buffer_create(tracer->report, tracer->device, (size_t)corners->chunk * line_bytes, NULL,
                         &corners->tallies);
}

sonject_status corners_begin(struct corners *corners, struct tracer *tracer, uint32_t part)
{
    memset(corners, 0, sizeof *corners);
    if (!corners_may_echo(tracer, part))
        return SONJECT_OK;
    lay_strips(corners, tracer, part);
    corners->grid.bins.first = corners->grid.bins.count = 0;
    corners->traces = allocate_array(CORNER_PAIRS_MAX, sizeof *corners->traces);
    if (!corners->traces)
        return report_out_of_memory(tracer->report, "echoes of corners");
    sonject_status status = begin_pairs(corners, tracer, part);
    if (status == SONJECT_OK && corners->count > 0)
        status = make_tallies(corners, tracer);
    if (corners->count == 0)
        corners->grid.strips.count = 0;
    if (status != SONJECT_OK)
        corners_end(corners);
    return status;
}

void corners_end(struct corners *corners)
{
    for (size_t i = 0; i < corners->count; i++)
        corner_trace_end(&corners->traces[i]);
    free(corners->traces);
    free(corners->real_part);
    free(corners->imaginary_part);
    buffer_release(&corners->tallies);
    memset(corners, 0, sizeof *corners);
}

/* Sub-strips of first hits whose echoes may lie in the given ones. */
static struct span launched_for(const struct corners *corners, struct span strips)
{
    /* at its edge a strip may round into the next */
    int32_t first = strips.first - 1;
    int32_t end = strips.first + strips.count + 1;
    if (corners->is_focused) {
        first = 2 * first - (corners->last_hits.first + corners->last_hits.count);
        end = 2 * end - corners->last_hits.first;
    }
    const int32_t last = corners->first_hits.first + corners->first_hits.count;
    struct span launched;
    launched.first = first > corners->first_hits.first ? first : corners->first_hits.first;
    launched.count = (end < last ? end : last) - launched.first;
    launched.count = launched.count > 0 ? launched.count : 0;
    return launched;
}

sonject_status corner_trace_strips(struct corners *corners, struct tracer *tracer, size_t number,
                                   struct span strips, float *real_part, float *imaginary_part)
{
    struct corner_trace *trace = &corners->traces[number];
    struct report *report = tracer->report;
    struct device *device = tracer->device;
    const size_t count = (size_t)strips.count * (size_t)trace->bins.count;
    const size_t bytes = 2 * count * sizeof(int64_t);
    const cl_mem buffers[] = {trace->on_device.objects, corners->tallies, trace->sources,
                              trace->corners};
    const struct span launched = launched_for(corners, strips);
    const void *mapped;
    trace->fan.first_strip = launched.first;
    trace->fan.strips = launched.count;
    trace->record.tally_first_strip = strips.first;
    trace->record.tally_strips = strips.count;
    sonject_status status =
        buffer_write(report, device, trace->corners, 0, sizeof trace->record, &trace->record);
    if (status == SONJECT_OK)
        status = buffer_clear(report, device, corners->tallies, bytes);
    if (status == SONJECT_OK && launched.count > 0)
        status =
            trace_launch(tracer, trace->on_device.kernel, &trace->fan, &trace->rays, buffers, 4);
    if (status == SONJECT_OK)
        status = buffer_map(report, device, corners->tallies, bytes, &mapped);
    if (status != SONJECT_OK)
        return status;
    const int64_t *tallies = mapped;
    for (size_t i = 0; i < count; i++) {
        real_part[i] = (float)((double)tallies[2 * i] * trace->amplitude_of_quantum);
        imaginary_part[i] = (float)((double)tallies[2 * i + 1] * trace->amplitude_of_quantum);
    }
    buffer_unmap(device, corners->tallies, mapped);
    return SONJECT_OK;
}

/* Adds one pair's strips; first_line: of the planes. */
static void add_strips(const struct corners *corners, const struct corner_trace *trace,
                       int32_t strips, size_t first_line, const struct line_grid *grid,
                       float *real_part, float *imaginary_part)
{
    const size_t width = (size_t)trace->bins.count;
    const size_t offset = (size_t)(trace->bins.first - grid->bins.first);
    for (size_t strip = 0; strip < (size_t)strips; strip++) {
        const size_t at = (first_line + strip) * (size_t)grid->bins.count + offset;
        for (size_t bin = 0; bin < width; bin++) {
            real_part[at + bin] += corners->real_part[strip * width + bin];
            imaginary_part[at + bin] += corners->imaginary_part[strip * width + bin];
        }
    }
}

sonject_status corners_add(struct corners *corners, struct tracer *tracer, struct span strips,
                           const struct line_grid *grid, float *real_part, float *imaginary_part)
{
    const struct span wanted = span_overlap(strips, corners->grid.strips);
    for (size_t i = 0; i < corners->count; i++)
        for (int32_t done = 0; done < wanted.count; done += corners->chunk) {
            const int32_t left = wanted.count - done;
            const struct span some = {wanted.first + done,
                                      left < corners->chunk ? left : corners->chunk};
            const sonject_status status = corner_trace_strips(
                corners, tracer, i, some, corners->real_part, corners->imaginary_part);
            if (status != SONJECT_OK)
                return status;
            add_strips(corners, &corners->traces[i], some.count,
                       (size_t)(some.first - strips.first), grid, real_part, imaginary_part);
        }
    return SONJECT_OK;
}
