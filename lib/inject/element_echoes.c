#include "inject/element_echoes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "elements/series.h"
#include "inject/coherent_seabed.h"
#include "inject/patch_level.h"
#include "inject/traced_impulses.h"

#define TRACE_SHARE 0.5 /* of a run's progress */

/* Takes the impulses that an image would be made of, with the same deviates. */
struct element_taker {
    struct tracer *tracer;
    const struct echo_request *request;
    struct impulse_list impulses;
    float *chains; /* energies of all orders, m^2; NULL until the first */
    struct line_grid chains_grid;
};

static sonject_status take_coherent_seabed(struct element_taker *taker,
                                           const struct impulse_lines *lines)
{
    const size_t cells = (size_t)lines->strips.count * (size_t)lines->grid.bins.count;
    float *real_part = allocate_array(cells, sizeof *real_part);
    float *imaginary_part = allocate_array(cells, sizeof *imaginary_part);
    sonject_status status = real_part && imaginary_part
                                ? SONJECT_OK
                                : report_out_of_memory(taker->tracer->report, "the seabed");
    if (status == SONJECT_OK) {
        memcpy(real_part, lines->plane[1], cells * sizeof *real_part);
        coherent_seabed_lines(&lines->grid, taker->tracer, lines->strips,
                              taker->request->reflectivity_real,
                              taker->request->reflectivity_imaginary, real_part, imaginary_part);
        status = impulse_list_add(&taker->impulses, &lines->grid, lines->strips, real_part,
                                  imaginary_part);
    }
    free(real_part);
    free(imaginary_part);
    return status;
}

static sonject_status take_speckle(struct element_taker *taker, const struct impulse_lines *lines,
                                   const float *energy, uint32_t stream)
{
    return impulse_list_add_speckle(&taker->impulses, &lines->grid, lines->strips, energy,
                                    taker->tracer->scene->injection.seed, stream);
}

/* Orders are added up, and drawn together at the end. */
static sonject_status take_chains(struct element_taker *taker, const struct impulse_lines *lines)
{
    const size_t cells = line_grid_cells(&lines->grid);
    if (!taker->chains) {
        taker->chains = allocate_array(cells, sizeof *taker->chains);
        taker->chains_grid = lines->grid;
    }
    if (!taker->chains)
        return report_out_of_memory(taker->tracer->report, "multiple interactions");
    for (size_t i = 0; i < cells; i++)
        taker->chains[i] += lines->plane[0][i];
    return SONJECT_OK;
}

static sonject_status take_seabed(struct element_taker *taker, const struct impulse_lines *lines)
{
    switch (taker->request->field) {
    case SEABED_FIELD_NONE:
        return SONJECT_OK;
    case SEABED_FIELD_COHERENT:
        return take_coherent_seabed(taker, lines);
    case SEABED_FIELD_SPECKLE:
        break;
    }
    return take_speckle(taker, lines, lines->plane[1], STREAM_SEABED_SPECKLE);
}

static sonject_status take(void *user, const struct impulse_lines *lines)
{
    struct element_taker *taker = user;
    switch (lines->kind) {
    case IMPULSES_SEABED:
        return take_seabed(taker, lines);
    case IMPULSES_OBJECT:
        return take_speckle(taker, lines, lines->plane[TILE_ENERGY],
                            STREAM_OBJECT_SPECKLE + lines->number);
    case IMPULSES_GLINT:
        return impulse_list_add(&taker->impulses, &lines->grid, lines->strips, lines->plane[0],
                                lines->plane[1]);
    case IMPULSES_LEVEL:
        return SONJECT_OK;
    case IMPULSES_CHAINS:
        return take_chains(taker, lines);
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

/* The tracer's own progress as the first share of the run's. */
struct trace_progress {
    sonject_progress_function progress;
    void *user;
};

static int tell_tracing(void *user, double fraction, const char *stage)
{
    const struct trace_progress *outer = user;
    return outer->progress ? outer->progress(outer->user, TRACE_SHARE * fraction, stage) : 0;
}

static sonject_status check_scene(struct report *report, const struct scene *scene, bool is_complex)
{
    if (scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the brute force estimator is a reference for images: use connect "
                              "for the element level");
    if (scene->injection.mode == SONJECT_MODE_RESYNTHESISE &&
        scene->seabed.map == SONJECT_MAP_COHERENT && !is_complex)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the coherent seabed map needs a complex image: use map: intensity "
                              "or despeckled");
    return SONJECT_OK;
}

/* A scene laid out on a patch; to be given to patch_scene_clear, also on failure. */
struct patch_scene {
    struct water water;
    struct placements placements;
    struct tracer tracer;
};

static sonject_status patch_scene_init(struct patch_scene *laid, struct report *report,
                                       const struct scene *scene,
                                       const struct injection_input *input)
{
    memset(laid, 0, sizeof *laid);
    struct tracer *tracer = &laid->tracer;
    sonject_status status = check_scene(report, scene, input->is_complex);
    if (status == SONJECT_OK)
        status = injection_check(report, scene, input->first_row, input->first_column, input->rows,
                                 input->columns, &laid->water, &tracer->view, &laid->placements);
    if (status != SONJECT_OK)
        return status;
    tracer->report = report;
    tracer->scene = scene;
    tracer->placements = laid->placements.parts;
    tracer->part_count = laid->placements.part_count;
    tracer->objects = laid->placements.objects;
    tracer->relief = laid->placements.relief;
    point_response_init(&tracer->response, &scene->sonar, scene_reference_speed(scene),
                        tracer->view.row_spacing_m);
    return SONJECT_OK;
}

static void patch_scene_clear(struct patch_scene *laid)
{
    placements_clear(&laid->placements);
    water_clear(&laid->water);
}

/* The patch's rows in the view's order. To be given to free(). */
static float *view_pixels(const struct tracer *tracer, const struct injection_input *input)
{
    const size_t row = input->columns * (input->is_complex ? 2 : 1);
    float *pixels = allocate_array(input->rows, row * sizeof *pixels);
    for (size_t i = 0; pixels && i < input->rows; i++)
        memcpy(pixels + i * row,
               input->pixels + (tracer->view.is_mirrored ? input->rows - 1 - i : i) * row,
               row * sizeof *pixels);
    return pixels;
}

static sonject_status hear(struct element_taker *taker, sonject_progress_function progress,
                           void *user, const sonject_element_layout *layout, float *series)
{
    struct tracer *tracer = taker->tracer;
    const struct series_request request = {
        layout, &tracer->view, &tracer->response, &taker->impulses, progress, user, TRACE_SHARE};
    return series_compute(&request, tracer->report, tracer->device, series);
}

/* Reflectivity of unit mean square for the coherent map: the pixels over the root of the level. To
 * be given to free(). */
static float *coherent_plane(const struct patch_level *level, const float *pixels, size_t count,
                             size_t part)
{
    float *plane = allocate_array(count, sizeof *plane);
    for (size_t i = 0; plane && i < count; i++)
        plane[i] = pixels[2 * i + part] / sqrtf(level->level[i]);
    return plane;
}

/* What image formation would ask for. On failure the planes are still to be freed. */
static sonject_status request_init(struct echo_request *request, const struct tracer *tracer,
                                   const struct patch_level *level, const float *pixels,
                                   float *planes[2])
{
    const size_t count = tracer->view.rows * tracer->view.columns;
    memset(request, 0, sizeof *request);
    request->map = level->map;
    request->field = SEABED_FIELD_NONE;
    if (tracer->scene->injection.mode != SONJECT_MODE_RESYNTHESISE)
        return SONJECT_OK;
    request->field = SEABED_FIELD_SPECKLE;
    if (tracer->scene->seabed.map != SONJECT_MAP_COHERENT)
        return SONJECT_OK;
    request->field = SEABED_FIELD_COHERENT;
    for (size_t part = 0; part < 2; part++)
        planes[part] = coherent_plane(level, pixels, count, part);
    request->reflectivity_real = planes[0];
    request->reflectivity_imaginary = planes[1];
    return planes[0] && planes[1] ? SONJECT_OK
                                  : report_out_of_memory(tracer->report, "the reflectivity");
}

static sonject_status trace_and_hear(struct tracer *tracer, const float *pixels, bool is_complex,
                                     sonject_progress_function progress, void *user,
                                     const sonject_element_layout *layout, float *series)
{
    struct trace_progress tracing = {progress, user};
    struct patch_level level;
    struct echo_request request;
    float *planes[2] = {NULL, NULL};
    struct element_taker taker;
    memset(&taker, 0, sizeof taker);
    sonject_status status = patch_level_init(&level, tracer->report, tracer->scene, &tracer->view,
                                             &tracer->response, pixels, is_complex);
    if (status != SONJECT_OK)
        return status;
    status = request_init(&request, tracer, &level, pixels, planes);
    if (status == SONJECT_OK) {
        request.progress = tell_tracing;
        request.user = &tracing;
        taker.tracer = tracer;
        taker.request = &request;
        impulse_list_init(&taker.impulses, tracer->report, tracer->device);
        status = gather(&taker);
        if (status == SONJECT_OK)
            status = hear(&taker, progress, user, layout, series);
        impulse_list_clear(&taker.impulses);
    }
    free(planes[0]);
    free(planes[1]);
    patch_level_clear(&level);
    return status;
}

sonject_status element_echoes_describe(struct report *report, const struct scene *scene,
                                       const struct injection_input *input,
                                       sonject_element_layout *layout)
{
    struct patch_scene laid;
    sonject_status status = patch_scene_init(&laid, report, scene, input);
    if (status == SONJECT_OK)
        status = element_plan(layout, report, scene, &laid.tracer.view, &laid.tracer.response);
    patch_scene_clear(&laid);
    return status;
}

sonject_status element_echoes_compute(struct report *report, struct device *device,
                                      const struct scene *scene,
                                      const struct injection_input *input,
                                      sonject_progress_function progress, void *user,
                                      const sonject_element_layout *layout, float *series)
{
    struct patch_scene laid;
    sonject_status status = patch_scene_init(&laid, report, scene, input);
    if (status == SONJECT_OK) {
        laid.tracer.device = device;
        float *pixels = view_pixels(&laid.tracer, input);
        status = pixels ? trace_and_hear(&laid.tracer, pixels, input->is_complex, progress, user,
                                         layout, series)
                        : report_out_of_memory(report, "the patch");
        free(pixels);
    }
    patch_scene_clear(&laid);
    return status;
}
