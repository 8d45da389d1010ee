#include "inject/chain_echoes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "form/form.h"
#include "trace/chains.h"

#define STRIPS_A_LAUNCH 64 /* between two looks at whether the caller cancels */

static bool is_brute_force(const struct tracer *tracer)
{
    return tracer->scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE;
}

static sonject_status trace_fan(struct chain_trace *trace, struct tracer *tracer,
                                const struct echo_request *request, uint32_t number)
{
    struct chain_fan fan;
    sonject_status status = chain_fan_init(&fan, tracer, &trace->grid, trace->has_map, number);
    const int32_t end = fan.strips.first + fan.strips.count;
    struct span strips = {fan.strips.first, STRIPS_A_LAUNCH};
    while (status == SONJECT_OK && strips.first < end) {
        if (strips.count > end - strips.first)
            strips.count = end - strips.first;
        status = chain_trace_strips(trace, tracer, &fan, strips);
        strips.first += strips.count;
        const double done =
            (number + (double)(strips.first - fan.strips.first) / fan.strips.count) /
            chain_fan_count(tracer);
        if (status == SONJECT_OK)
            status = echo_request_tell(request, tracer->report,
                                       ROUGH_SHARE + OBJECT_SHARE + CHAINS_SHARE * done,
                                       "tracing several interactions");
    }
    return status;
}

/* Two planes of energy on the grid, side by side, to the patch; the second may be NULL. */
static sonject_status form_energies(const struct chain_trace *trace, struct tracer *tracer,
                                    const float *first, const float *second, float *first_formed,
                                    float *second_formed)
{
    struct form_lines lines;
    sonject_status status = form_lines_begin(&lines, tracer->report, tracer->device, &tracer->view,
                                             &tracer->response, FORM_ENERGY, &trace->grid);
    if (status != SONJECT_OK)
        return status;
    status =
        form_lines_add(&lines, trace->grid.strips.first, trace->grid.strips.count, first, second);
    if (status == SONJECT_OK)
        status = form_lines_finish(&lines, first_formed, second_formed);
    form_lines_end(&lines);
    return status;
}

static sonject_status draw_speckle(const struct chain_trace *trace, struct tracer *tracer,
                                   const float *energy, float *real_part, float *imaginary_part)
{
    struct form_lines lines;
    sonject_status status = form_lines_begin(&lines, tracer->report, tracer->device, &tracer->view,
                                             &tracer->response, FORM_SPECKLE, &trace->grid);
    if (status != SONJECT_OK)
        return status;
    status = form_lines_add_speckle(&lines, trace->grid.strips.first, trace->grid.strips.count,
                                    energy, tracer->scene->injection.seed, STREAM_CHAIN_SPECKLE);
    if (status == SONJECT_OK)
        status = form_lines_finish(&lines, real_part, imaginary_part);
    form_lines_end(&lines);
    return status;
}

static void add_plane(float *sum, const float *plane, size_t count)
{
    for (size_t i = 0; i < count; i++)
        sum[i] += plane[i];
}

/* Planes of the size of the patch (formed) and of the grid (traced). */
struct chain_work {
    float *traced, *sum; /* one plane, and all of them together */
    float *formed, *unused;
    float *real_part, *imaginary_part;
};

static void chain_work_clear(struct chain_work *work)
{
    free(work->traced);
    free(work->sum);
    free(work->formed);
    free(work->unused);
    free(work->real_part);
    free(work->imaginary_part);
}

static sonject_status chain_work_init(struct chain_work *work, const struct chain_trace *trace,
                                      const struct echoes *echoes, struct tracer *tracer)
{
    const size_t cells = line_grid_cells(&trace->grid);
    const size_t pixels = echoes->rows * echoes->columns;
    memset(work, 0, sizeof *work);
    work->traced = allocate_array(cells, sizeof(float));
    work->sum = allocate_array(cells, sizeof(float));
    work->formed = allocate_array(pixels, sizeof(float));
    work->unused = allocate_array(pixels, sizeof(float));
    work->real_part = allocate_array(pixels, sizeof(float));
    work->imaginary_part = allocate_array(pixels, sizeof(float));
    if (!work->traced || !work->sum || !work->formed || !work->unused || !work->real_part ||
        !work->imaginary_part) {
        chain_work_clear(work);
        return report_out_of_memory(tracer->report, "multiple interactions");
    }
    return SONJECT_OK;
}

/* Reads the planes, forms those that are kept apart, and adds them up. */
static sonject_status take_planes(struct chain_work *work, struct chain_trace *trace,
                                  struct echoes *echoes, struct tracer *tracer)
{
    const size_t cells = line_grid_cells(&trace->grid);
    sonject_status status = SONJECT_OK;
    for (uint32_t plane = 0; status == SONJECT_OK && plane < trace->planes; plane++) {
        float *kept = echoes->order_energy[trace->first_order - 1 + plane];
        status = chain_trace_read(trace, tracer, plane, work->traced);
        if (status == SONJECT_OK && kept)
            status = form_energies(trace, tracer, work->traced, NULL, kept, work->unused);
        add_plane(work->sum, work->traced, cells);
    }
    return status;
}

static void add_to_image(struct chain_work *work, struct echoes *echoes, bool replaces_seabed)
{
    const size_t pixels = echoes->rows * echoes->columns;
    if (replaces_seabed) {
        memcpy(echoes->seabed_real, work->real_part, pixels * sizeof(float));
        memcpy(echoes->seabed_imaginary, work->imaginary_part, pixels * sizeof(float));
        add_plane(echoes->energy, work->formed, pixels);
        return;
    }
    add_plane(echoes->target_energy, work->formed, pixels);
    add_plane(echoes->energy, work->formed, pixels);
    add_plane(echoes->target_real, work->real_part, pixels);
    add_plane(echoes->target_imaginary, work->imaginary_part, pixels);
}

static sonject_status form_chains(struct chain_trace *trace, struct echoes *echoes,
                                  struct tracer *tracer)
{
    struct chain_work work;
    const double start = clock_seconds();
    sonject_status status = chain_work_init(&work, trace, echoes, tracer);
    if (status != SONJECT_OK)
        return status;
    status = take_planes(&work, trace, echoes, tracer);
    if (status == SONJECT_OK)
        status = form_energies(trace, tracer, work.sum, NULL, work.formed, work.unused);
    if (status == SONJECT_OK)
        status = draw_speckle(trace, tracer, work.sum, work.real_part, work.imaginary_part);
    if (status == SONJECT_OK)
        add_to_image(&work, echoes, is_brute_force(tracer));
    chain_work_clear(&work);
    echoes->form_s += clock_seconds() - start;
    return status;
}

static sonject_status allocate_orders(struct echoes *echoes, struct tracer *tracer)
{
    const size_t pixels = echoes->rows * echoes->columns;
    if (!tracer->scene->injection.order_energies)
        return SONJECT_OK;
    echoes->orders = tracer->scene->injection.interactions;
    for (uint32_t i = 0; i < echoes->orders; i++) {
        echoes->order_energy[i] = allocate_array(pixels, sizeof(float));
        if (!echoes->order_energy[i])
            return report_out_of_memory(tracer->report, "energies of each order");
    }
    return SONJECT_OK;
}

/* What one interaction brings: the energy of the objects' echoes, and of the seabed in view. By
 * brute force the chains bring it anew, all but the glints. */
static void take_first_order(struct echoes *echoes, const struct tracer *tracer)
{
    for (size_t i = 0; i < echoes->rows * echoes->columns; i++) {
        const float in_view = fmaxf(0.0f, echoes->seabed_energy[i] - echoes->lost_energy[i]);
        echoes->energy[i] = is_brute_force(tracer) ? 0.0f : echoes->target_energy[i] + in_view;
    }
    if (echoes->order_energy[0] && !is_brute_force(tracer))
        memcpy(echoes->order_energy[0], echoes->energy,
               echoes->rows * echoes->columns * sizeof(float));
}

sonject_status chain_echoes_compute(struct echoes *echoes, struct tracer *tracer,
                                    const struct echo_request *request)
{
    struct chain_trace trace;
    sonject_status status = allocate_orders(echoes, tracer);
    if (status != SONJECT_OK)
        return status;
    take_first_order(echoes, tracer);
    status = chain_trace_begin(&trace, tracer, request->map);
    if (status != SONJECT_OK || trace.orders == 0)
        return status;
    const double start = clock_seconds();
    for (uint32_t i = 0; status == SONJECT_OK && i < chain_fan_count(tracer); i++)
        status = trace_fan(&trace, tracer, request, i);
    echoes->trace_s += clock_seconds() - start;
    if (status == SONJECT_OK)
        status = form_chains(&trace, echoes, tracer);
    chain_trace_end(&trace);
    return status;
}
