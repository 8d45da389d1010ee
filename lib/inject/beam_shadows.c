#include "inject/beam_shadows.h"

#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "form/form.h"

/* A response that keeps rows apart: a ping's energies are its row's as they are. */
static void response_of_pings(struct point_response *response, const struct tracer *tracer)
{
    sonject_sonar_params sonar = tracer->scene->sonar;
    sonar.kind = SONJECT_SONAR_SYNTHETIC;
    sonar.response_window = SONJECT_WINDOW_RECTANGULAR;
    sonar.along_track_resolution_m = tracer->view.row_spacing_m;
    point_response_init(response, &sonar, scene_reference_speed(tracer->scene),
                        tracer->view.row_spacing_m);
}

struct beam_work {
    struct rough_trace trace;
    struct point_response response;
    float *chunk, *tiles;
    float *seabed, *plane, *unused; /* of the patch's size */
};

static sonject_status trace_pings(struct beam_work *work, struct echoes *echoes,
                                  struct tracer *tracer, const struct echo_request *request)
{
    struct rough_trace *trace = &work->trace;
    struct form_lines lines;
    sonject_status status = form_lines_begin(&lines, tracer->report, tracer->device, &tracer->view,
                                             &work->response, FORM_ENERGY, &trace->grid);
    if (status != SONJECT_OK)
        return status;
    const uint64_t pings = tracer->counts.pings;
    const int32_t end = trace->grid.strips.first + trace->grid.strips.count;
    struct span strips = {trace->grid.strips.first, rough_trace_chunk(trace)};
    while (status == SONJECT_OK && strips.first < end) {
        if (strips.count > end - strips.first)
            strips.count = end - strips.first;
        const double start = clock_seconds();
        status = rough_trace_strips(trace, tracer, strips, work->chunk);
        echoes->trace_s += clock_seconds() - start;
        if (status == SONJECT_OK)
            status = form_lines_add(&lines, strips.first, strips.count, work->chunk, NULL);
        strips.first += strips.count;
        if (status == SONJECT_OK)
            status = echo_request_tell(request, tracer->report, ROUGH_SHARE + OBJECT_SHARE,
                                       "tracing the beam");
    }
    tracer->counts.pings = pings; /* the same ones */
    if (status == SONJECT_OK)
        status = form_lines_finish(&lines, work->seabed, work->unused);
    form_lines_end(&lines);
    return status;
}

/* What an object hides, formed on `columns` columns from first_column on, in work->plane: its share
 * of what the ping would hear. */
static void take_lost(const struct beam_work *work, struct echoes *echoes, struct object_echo *echo,
                      size_t first_column, size_t columns)
{
    for (size_t row = 0; row < echoes->rows; row++)
        for (size_t k = 0; k < columns; k++) {
            const size_t column = first_column + k;
            const size_t pixel = row * echoes->columns + column;
            const float all = work->seabed[pixel];
            const float share = all > 0.0f ? work->plane[row * columns + k] / all : 0.0f;
            const float lost = echoes->seabed_energy[pixel] * (share < 1.0f ? share : 1.0f);
            echoes->lost_energy[pixel] += lost;
            if (echo->lost && column >= echo->first_column &&
                column - echo->first_column < echo->columns)
                echo->lost[row * echo->columns + (column - echo->first_column)] = lost;
        }
}

static sonject_status form_lost(struct beam_work *work, struct echoes *echoes,
                                struct tracer *tracer, uint32_t number)
{
    struct object_echo *echo = &echoes->objects[number];
    const struct rough_tile *tile = &work->trace.tiles[number];
    const size_t cells = line_grid_cells(&tile->grid);
    struct form_lines lines;
    if (echo->lost)
        memset(echo->lost, 0, echoes->rows * echo->columns * sizeof(float));
    if (cells == 0)
        return SONJECT_OK;
    sonject_status status = form_lines_begin(&lines, tracer->report, tracer->device, &tracer->view,
                                             &work->response, FORM_ENERGY, &tile->grid);
    if (status != SONJECT_OK)
        return status;
    status = form_lines_add(&lines, tile->grid.strips.first, tile->grid.strips.count,
                            work->tiles + tile->offset + TILE_LOST * cells, NULL);
    if (status == SONJECT_OK)
        status = form_lines_finish(&lines, work->plane, work->unused);
    if (status == SONJECT_OK)
        take_lost(work, echoes, echo, lines.first_column, lines.columns);
    form_lines_end(&lines);
    return status;
}

static sonject_status compute(struct beam_work *work, struct echoes *echoes, struct tracer *tracer,
                              const struct echo_request *request)
{
    const size_t pixels = echoes->rows * echoes->columns;
    work->chunk = allocate_array((size_t)rough_trace_chunk(&work->trace) *
                                     (size_t)work->trace.grid.bins.count,
                                 sizeof(float));
    work->tiles = allocate_array(work->trace.tile_elements, sizeof(float));
    work->seabed = allocate_array(pixels, sizeof(float));
    work->plane = allocate_array(pixels, sizeof(float));
    work->unused = allocate_array(pixels, sizeof(float));
    if (!work->chunk || !work->tiles || !work->seabed || !work->plane || !work->unused)
        return report_out_of_memory(tracer->report, "the beam's shadows");
    sonject_status status = trace_pings(work, echoes, tracer, request);
    if (status == SONJECT_OK)
        status = rough_trace_tiles(&work->trace, tracer, work->tiles);
    memset(echoes->lost_energy, 0, pixels * sizeof(float));
    for (uint32_t i = 0; status == SONJECT_OK && i < echoes->object_count; i++)
        status = form_lost(work, echoes, tracer, i);
    return status;
}

sonject_status beam_shadows_compute(struct echoes *echoes, struct tracer *tracer,
                                    const struct echo_request *request)
{
    if (tracer->scene->sonar.kind != SONJECT_SONAR_REAL || tracer->relief)
        return SONJECT_OK;
    struct beam_work *work = allocate_array(1, sizeof *work);
    if (!work)
        return report_out_of_memory(tracer->report, "the beam's shadows");
    response_of_pings(&work->response, tracer);
    sonject_status status = rough_trace_begin_beam(&work->trace, tracer, &work->response);
    if (status == SONJECT_OK) {
        status = compute(work, echoes, tracer, request);
        rough_trace_end(&work->trace);
    }
    free(work->chunk);
    free(work->tiles);
    free(work->seabed);
    free(work->plane);
    free(work->unused);
    free(work);
    return status;
}
