#include "inject/level_seabed.h"

#include <math.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/memory.h"
#include "form/form.h"

#define PATTERN_FLOOR 1e-6f /* a black pixel's share in view must still be known */

static bool is_composite(const struct echo_request *request)
{
    return request->field == SEABED_FIELD_NONE;
}

const float *seabed_map(const struct tracer *tracer, const struct echo_request *request)
{
    return tracer->relief && is_composite(request) ? NULL : request->map;
}

static sonject_status trace_strips(struct echoes *echoes, struct tracer *tracer,
                                   const struct echo_request *request, struct rough_trace *trace,
                                   struct form_lines *lines, float *chunk)
{
    const int32_t end = trace->grid.strips.first + trace->grid.strips.count;
    struct span strips = {trace->grid.strips.first, rough_trace_chunk(trace)};
    const uint64_t pings = tracer->counts.pings;
    sonject_status status = SONJECT_OK;
    while (status == SONJECT_OK && strips.first < end) {
        if (strips.count > end - strips.first)
            strips.count = end - strips.first;
        const double start = clock_seconds();
        status = rough_trace_strips(trace, tracer, strips, chunk);
        echoes->trace_s += clock_seconds() - start;
        if (status == SONJECT_OK)
            status = form_lines_add(lines, strips.first, strips.count, chunk, NULL);
        strips.first += strips.count;
        if (status == SONJECT_OK)
            status = echo_request_tell(request, tracer->report, ROUGH_SHARE + OBJECT_SHARE,
                                       "tracing the level seabed");
    }
    tracer->counts.pings = pings; /* the same ones */
    return status;
}

static void multiply(float *plane, const float *map, size_t rows, size_t columns,
                     size_t first_column, size_t map_columns)
{
    for (size_t row = 0; row < rows; row++)
        for (size_t column = 0; column < columns; column++)
            plane[row * columns + column] *=
                fmaxf(map[row * map_columns + first_column + column], PATTERN_FLOOR);
}

/* Gives energies that were traced with an even reflectivity the map's pattern. */
static void take_pattern(struct echoes *echoes, const float *map)
{
    const size_t rows = echoes->rows;
    const size_t columns = echoes->columns;
    multiply(echoes->seabed_energy, map, rows, columns, 0, columns);
    multiply(echoes->lost_energy, map, rows, columns, 0, columns);
    multiply(echoes->level_energy, map, rows, columns, 0, columns);
    for (uint32_t i = 0; i < echoes->object_count; i++)
        if (echoes->objects[i].lost)
            multiply(echoes->objects[i].lost, map, rows, echoes->objects[i].columns,
                     echoes->objects[i].first_column, columns);
}

sonject_status level_seabed_compute(struct echoes *echoes, struct tracer *tracer,
                                    const struct echo_request *request, struct rough_trace *trace)
{
    const size_t pixels = echoes->rows * echoes->columns;
    struct form_lines lines;
    sonject_status status = form_lines_begin(&lines, tracer->report, tracer->device, &tracer->view,
                                             &tracer->response, FORM_ENERGY, &trace->grid);
    if (status != SONJECT_OK)
        return status;
    float *unused = allocate_array(pixels, sizeof *unused);
    float *chunk = allocate_array((size_t)rough_trace_chunk(trace) * (size_t)trace->grid.bins.count,
                                  sizeof *chunk);
    echoes->level_energy = allocate_array(pixels, sizeof(float));
    rough_trace_flatten(trace);
    status = unused && chunk && echoes->level_energy
                 ? trace_strips(echoes, tracer, request, trace, &lines, chunk)
                 : report_out_of_memory(tracer->report, "the level seabed");
    if (status == SONJECT_OK)
        status = form_lines_finish(&lines, echoes->level_energy, unused);
    if (status == SONJECT_OK && request->map && is_composite(request))
        take_pattern(echoes, request->map);
    form_lines_end(&lines);
    free(unused);
    free(chunk);
    return status;
}
