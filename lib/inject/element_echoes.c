#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/report.h"
#include "elements/elements.h"
#include "inject/accuracy.h"
#include "inject/compose.h"
#include "scene/placement.h"

#define TRACE_SHARE 0.5 /* share of a run's progress */

/* The taker of the impulses that an image would be formed of, with the same deviates. */
struct element_taker {
    struct tracer *tracer;
    const struct echo_request *request;
    struct impulse_list impulses;
    float *chains; /* energies of all orders, m^2; NULL until the first comes */
    struct line_grid chains_grid;
};

static sonject_status add_coherent_seabed(struct element_taker *taker,
                                          const struct impulse_lines *lines)
{
    const size_t cells = (size_t)lines->strips.count * (size_t)lines->grid.bins.count;
    float *parts = coherent_seabed_lines(taker->tracer, taker->request, lines);
    CHECK_MEMORY(taker->tracer->report, parts, "the seabed");
    const sonject_status status =
        impulse_list_add(&taker->impulses, &lines->grid, lines->strips, parts, parts + cells);
    free(parts);
    return status;
}

static sonject_status add_speckle(struct element_taker *taker, const struct impulse_lines *lines,
                                  const float *energy, uint32_t stream)
{
    return impulse_list_add_speckle(&taker->impulses, &lines->grid, lines->strips, energy,
                                    taker->tracer->scene->injection.seed, stream);
}

/* Adds up the orders' energies, which are drawn together at the end. */
static sonject_status add_chains(struct element_taker *taker, const struct impulse_lines *lines)
{
    const size_t cells = line_grid_cells(&lines->grid);
    if (!taker->chains) {
        taker->chains = allocate_array(cells, sizeof *taker->chains);
        taker->chains_grid = lines->grid;
    }
    CHECK_MEMORY(taker->tracer->report, taker->chains, "multiple interactions");
    for (size_t i = 0; i < cells; i++)
        taker->chains[i] += lines->plane[0][i];
    return SONJECT_OK;
}

static sonject_status form_seabed(struct element_taker *taker, const struct impulse_lines *lines)
{
    switch (taker->request->field) {
    case SEABED_FIELD_NONE:
        return SONJECT_OK;
    case SEABED_FIELD_COHERENT:
        return add_coherent_seabed(taker, lines);
    case SEABED_FIELD_SPECKLE:
        break;
    }
    return add_speckle(taker, lines, lines->plane[1], STREAM_SEABED_SPECKLE);
}

static sonject_status take(void *user, const struct impulse_lines *lines)
{
    struct element_taker *taker = user;
    struct line_grid grid = lines->grid;
    grid.bins = lines->bins;
    switch (lines->kind) {
    case IMPULSES_SEABED:
        return form_seabed(taker, lines);
    case IMPULSES_OBJECT:
        return add_speckle(taker, lines, lines->plane[TILE_ENERGY],
                           STREAM_OBJECT_SPECKLE + lines->number);
    case IMPULSES_GLINT:
    case IMPULSES_MULTIBOUNCE:
        return impulse_list_add(&taker->impulses, &grid, lines->strips, lines->plane[0],
                                lines->plane[1]);
    case IMPULSES_BEAM:
    case IMPULSES_HIDDEN:
    case IMPULSES_LEVEL:
        return SONJECT_OK;
    case IMPULSES_CHAINS:
        return add_chains(taker, lines);
    }
    return SONJECT_OK;
}

static sonject_status gather(struct element_taker *taker)
{
    const struct impulse_sink sink = {take, taker};
    sonject_status status = trace_impulses(taker->tracer, taker->request, &sink);
    if (status == SONJECT_OK && taker->chains)
        status = impulse_list_add_speckle(
            &taker->impulses, &taker->chains_grid, taker->chains_grid.strips, taker->chains,
            taker->tracer->scene->injection.seed, STREAM_CHAIN_SPECKLE);
    free(taker->chains);
    taker->chains = NULL;
    return status;
}

static sonject_status check_scene(struct report *report, const struct scene *scene)
{
    if (!aperture_motion_is_still(&scene->motion))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "sonar.motion works only in images: remove it for elements");
    if (scene->sonar.kind == SONJECT_SONAR_REAL && sonar_array_is_turned(&scene->sonar))
        return report_failure(
            report, SONJECT_ERROR_INPUT,
            "the array of elements lies along the track: set sonar.array's heading and pitch to 0");
    for (uint32_t i = 0; i < scene->object_count; i++)
        if (scene->objects[i].level_kind != SONJECT_LEVEL_PHYSICAL)
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "objects[%u].level works only in images: remove it for elements, "
                                  "whose levels follow from shape and material",
                                  (unsigned)i);
    if (scene->injection.estimator == SONJECT_ESTIMATOR_CONNECT)
        return SONJECT_OK;
    return report_failure(
        report, SONJECT_ERROR_INPUT,
        "the brute force estimator works only in images: use connect for elements");
}

static sonject_status hear(struct element_taker *taker, sonject_progress_function progress,
                           void *user, const sonject_element_layout *layout, float *series)
{
    struct tracer *tracer = taker->tracer;
    if (!isnan(layout->elements.source_level_db))
        impulse_list_set_source_level(&taker->impulses, &tracer->view,
                                      layout->elements.source_level_db,
                                      tracer->scene->medium.absorption_db_per_m);
    const struct series_request request = {
        layout, &tracer->view, &tracer->response, &taker->impulses, progress, user, TRACE_SHARE};
    return series_compute(&request, tracer->report, tracer->device, series);
}

static sonject_status trace_and_hear(struct injection_setup *setup, bool is_complex,
                                     sonject_progress_function progress, void *user,
                                     const sonject_element_layout *layout, float *series)
{
    struct tracer *tracer = &setup->tracer;
    struct progress_share tracing = {progress, user, 0.0, TRACE_SHARE};
    struct patch_request patch;
    struct element_taker taker;
    const struct patch_view *view = &tracer->view;
    struct patch_facts facts;
    sonject_status status =
        patch_facts_init(&facts, tracer->report, tracer->scene, view, setup->pixels, is_complex);
    THEN(status, patch_request_init(&patch, tracer, view, &facts, setup->pixels, is_complex,
                                    progress_share_tell, &tracing));
    CHECK(status);
    memset(&taker, 0, sizeof taker);
    taker.tracer = tracer;
    taker.request = &patch.request;
    impulse_list_init(&taker.impulses, tracer->report, tracer->device);
    status = gather(&taker);
    THEN(status, hear(&taker, progress, user, layout, series));
    impulse_list_clear(&taker.impulses);
    patch_request_clear(&patch);
    return status;
}

sonject_status element_echoes_describe(struct report *report, const struct scene *scene,
                                       const struct injection_input *input,
                                       sonject_element_layout *layout)
{
    struct injection_setup setup;
    CHECK(check_scene(report, scene));
    sonject_status status = injection_setup_init_scene(&setup, report, NULL, scene, input);
    THEN(status, element_plan(layout, report, scene, &setup.tracer.view, &setup.tracer.response));
    injection_setup_clear(&setup);
    return status;
}

sonject_status element_echoes_compute(struct report *report, struct device *device,
                                      const struct scene *scene,
                                      const struct injection_input *input,
                                      sonject_progress_function progress, void *user,
                                      const sonject_element_layout *layout, float *series)
{
    struct injection_setup setup;
    struct injection_input with = *input;
    struct pilots pilots;
    CHECK(check_scene(report, scene));
    CHECK(pilots_find(&pilots, report, device, &scene, &with, progress, user));
    sonject_status status = injection_setup_init(&setup, report, device, scene, &with);
    THEN(status, trace_and_hear(&setup, input->is_complex, progress, user, layout, series));
    injection_setup_clear(&setup);
    pilots_clear(&pilots);
    return status;
}
