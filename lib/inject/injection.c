#include "inject/injection.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/synthetic.h"
#include "inject/compose.h"
#include "scene/point_response.h"

sonject_status make_input(struct report *report, const struct scene *scene,
                          struct injection_input *input)
{
    const sonject_synthetic_params *synthetic = &scene->synthetic;
    const bool is_synthetic = scene->input_kind == SONJECT_INPUT_SYNTHETIC;
    const double reference = scene_reference_speed(scene);
    struct point_response response;
    memset(input, 0, sizeof *input);
    input->is_made = true;
    input->rows = is_synthetic ? synthetic->rows : scene->uniform_rows;
    input->columns = is_synthetic ? synthetic->columns : scene->uniform_columns;
    input->is_complex = is_synthetic && synthetic->complex_pixels;
    const size_t count = input->rows * input->columns;
    float *pixels = allocate_array(count, (input->is_complex ? 2 : 1) * sizeof *pixels);
    CHECK_MEMORY(report, pixels, is_synthetic ? "the synthetic seabed" : "the uniform seabed");
    input->pixels = pixels;
    for (size_t i = 0; !is_synthetic && i < count; i++)
        pixels[i] = 1.0f;
    if (!is_synthetic)
        return SONJECT_OK;
    point_response_init(&response, &scene->sonar, reference, scene->geometry.row_spacing_m);
    const sonject_status status =
        synthesise_seabed(report, synthetic, &scene->geometry, response.resolution_m,
                          reference / (2.0 * scene->sonar.bandwidth_hz), pixels);
    if (status != SONJECT_OK) {
        free(pixels);
        input->pixels = NULL;
    }
    return status;
}

/* Puts count things of so many bytes each in reverse order. */
static void reverse(char *things, size_t count, size_t bytes)
{
    for (size_t k = 0; k < count / 2; k++) {
        char *a = things + k * bytes;
        char *b = things + (count - 1 - k) * bytes;
        for (size_t i = 0; i < bytes; i++) {
            const char kept = a[i];
            a[i] = b[i];
            b[i] = kept;
        }
    }
}

/* From the image's order of rows and columns into the view's, or back. */
static void turn(const struct patch_view *view, void *plane, size_t pixel_bytes)
{
    const size_t row_bytes = view->columns * pixel_bytes;
    if (view->is_mirrored)
        reverse(plane, view->rows, row_bytes);
    for (size_t row = 0; view->is_reversed && row < view->rows; row++)
        reverse((char *)plane + row * row_bytes, view->columns, pixel_bytes);
}

static sonject_status check_combination(struct report *report, const struct scene *scene,
                                        bool is_complex)
{
    if (scene->injection.mode == SONJECT_MODE_RESYNTHESISE &&
        scene->seabed.map == SONJECT_MAP_COHERENT && !is_complex)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the coherent seabed map needs a complex image: use map: intensity "
                              "or despeckled");
    for (uint32_t i = 0; i < scene->object_count; i++)
        if (scene->objects[i].level_kind != SONJECT_LEVEL_PHYSICAL &&
            scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE)
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "objects[%u].level needs the estimator connect: brute force does "
                                  "not tell objects and seabed apart",
                                  (unsigned)i);
    return SONJECT_OK;
}

static sonject_status check_straight_rays(const struct tracer *tracer)
{
    if (tracer->scene->injection.estimator != SONJECT_ESTIMATOR_BRUTE_FORCE ||
        tracer->view.water.is_straight)
        return SONJECT_OK;
    return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                          "the brute force estimator follows straight rays only: use connect where "
                          "layers of water bend them");
}

/* The coherent map's scale is known for one real cross-range response. */
static sonject_status check_coherent_map(const struct tracer *tracer)
{
    const struct scene *scene = tracer->scene;
    if (scene->injection.mode != SONJECT_MODE_RESYNTHESISE ||
        scene->seabed.map != SONJECT_MAP_COHERENT || cross_range_is_plain(&tracer->response))
        return SONJECT_OK;
    return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                          "the coherent seabed map needs a synthetic aperture without motion or a "
                          "measured cross-range response: use map: intensity or despeckled");
}

/* The sonar's response on the patch. */
static sonject_status find_response(struct tracer *tracer)
{
    const struct patch_view *view = &tracer->view;
    CHECK(point_response_of_scene(&tracer->response, tracer->report, tracer->scene, view,
                                  view->range_ratio * view->water.water->straight_speed_mps));
    CHECK(cross_range_check(&tracer->response, tracer->report, tracer->scene, view));
    return check_coherent_map(tracer);
}

void injection_setup_clear(struct injection_setup *setup)
{
    placements_clear(&setup->placements);
    water_clear(&setup->water);
    free(setup->pixels);
}

sonject_status injection_setup_init_scene(struct injection_setup *setup, struct report *report,
                                          struct device *device, const struct scene *scene,
                                          const struct injection_input *input)
{
    struct tracer *tracer = &setup->tracer;
    char lines[REPORT_CAPACITY] = "";
    memset(setup, 0, sizeof *setup);
    tracer->report = report;
    tracer->device = device;
    tracer->scene = scene;
    tracer->checkpoint = input->checkpoint;
    sonject_status status = scene_locate(
        scene, report, check_combination(report, scene, input->is_complex), "injection");
    status = report_gather(report, lines, SONJECT_OK, status);
    sonject_status of_view = scene_lay_water(scene, report, &setup->water);
    THEN(of_view,
         scene_locate(scene, report,
                      patch_view_init(&tracer->view, report, scene, &setup->water, input->first_row,
                                      input->first_column, input->rows, input->columns),
                      "input.geometry"));
    status = report_gather(report, lines, status, of_view);
    if (of_view != SONJECT_OK)
        return status;
    status = report_gather(report, lines, status,
                           placements_init(&setup->placements, report, scene, &tracer->view,
                                           input->first_row, input->first_column));
    tracer->placements = setup->placements.parts;
    tracer->part_count = setup->placements.part_count;
    tracer->objects = setup->placements.objects;
    tracer->relief = setup->placements.relief;
    sonject_status of_sonar = check_straight_rays(tracer);
    THEN(of_sonar, find_response(tracer));
    return report_gather(report, lines, status, scene_locate(scene, report, of_sonar, "sonar"));
}

sonject_status injection_setup_init(struct injection_setup *setup, struct report *report,
                                    struct device *device, const struct scene *scene,
                                    const struct injection_input *input)
{
    const size_t pixel_bytes = (input->is_complex ? 2 : 1) * sizeof(float);
    CHECK(injection_setup_init_scene(setup, report, device, scene, input));
    setup->pixels = allocate_array(input->rows, input->columns * pixel_bytes);
    CHECK_MEMORY(report, setup->pixels, "the patch");
    memcpy(setup->pixels, input->pixels, input->rows * input->columns * pixel_bytes);
    turn(&setup->tracer.view, setup->pixels, pixel_bytes);
    return SONJECT_OK;
}

void injection_result_clear(struct injection_result *result)
{
    free(result->memory);
    for (int i = 0; i < SCENE_INTERACTIONS_MAX; i++)
        free(result->order_energy[i]);
    free(result->objects);
    memset(result, 0, sizeof *result);
}

static sonject_status result_init(struct injection_result *result, struct report *report,
                                  const struct scene *scene, const struct injection_input *input)
{
    const size_t pixels = input->rows * input->columns;
    const size_t parts = input->is_complex ? 2 : 1;
    sonject_statistics *statistics = &result->statistics;
    memset(result, 0, sizeof *result);
    result->rows = input->rows;
    result->columns = input->columns;
    result->is_complex = input->is_complex;
    result->object_count = scene->object_count;
    statistics->level_change_db = statistics->histogram_distance = statistics->correlation = NAN;
    statistics->input_contrast = statistics->output_contrast = NAN;
    statistics->struct_size = sizeof *statistics;
    result->memory = allocate_array(pixels, (parts + 4) * sizeof(float) + 4);
    result->objects = allocate_array(scene->object_count, sizeof *result->objects);
    CHECK_MEMORY(report, result->memory && result->objects, "the result");
    result->image = result->memory;
    result->field = result->image + parts * pixels;
    result->energy = result->field + 2 * pixels;
    result->visibility = result->energy + pixels;
    result->highlight = (uint8_t *)(result->visibility + pixels);
    result->shadow = result->highlight + pixels;
    result->labels = result->shadow + pixels;
    result->influence = result->labels + pixels;
    return SONJECT_OK;
}

static void turn_box(const struct patch_view *view, sonject_box *box)
{
    if (box->rows > 0 && view->is_mirrored)
        box->first_row = view->rows - box->first_row - box->rows;
    if (box->rows > 0 && view->is_reversed)
        box->first_column = view->columns - box->first_column - box->columns;
}

/* From the view back into the image's own pixels. */
static void turn_back(const struct patch_view *view, struct injection_result *result)
{
    turn(view, result->image, sizeof(float) * (result->is_complex ? 2 : 1));
    turn(view, result->field, sizeof(float) * 2);
    turn(view, result->energy, sizeof(float));
    turn(view, result->visibility, sizeof(float));
    for (uint32_t i = 0; i < result->orders; i++)
        turn(view, result->order_energy[i], sizeof(float));
    turn(view, result->highlight, 1);
    turn(view, result->shadow, 1);
    turn(view, result->labels, 1);
    turn(view, result->influence, 1);
    for (uint32_t i = 0; i < result->object_count; i++) {
        sonject_object_truth *truth = &result->objects[i];
        truth->column = view_patch_column(view, truth->column);
        if (view->is_mirrored) {
            truth->row = (double)(view->rows - 1) - truth->row;
            truth->along_track_m = -truth->along_track_m;
        }
        turn_box(view, &truth->highlight);
        turn_box(view, &truth->shadow);
        turn_box(view, &truth->both);
    }
}

/* The numbers of the paper's Figure 5: how the resynthesised seabed compares with the measured one
 * where no object is in view. */
static sonject_status compare_seabed(struct report *report, const struct echoes *echoes,
                                     const struct patch_level *level,
                                     struct injection_result *result)
{
    const size_t pixels = result->rows * result->columns;
    sonject_statistics *statistics = &result->statistics;
    float *before = allocate_array(2 * pixels, sizeof *before);
    float *after = before + pixels;
    size_t count = 0;
    sonject_status status = SONJECT_OK;
    CHECK_MEMORY(report, before, "the comparison");
    for (size_t i = 0; i < pixels; i++) {
        if (echoes->lost_energy[i] > 1e-3f * echoes->seabed_energy[i] ||
            echoes->target_energy[i] > 1e-3f * echoes->seabed_energy[i])
            continue;
        const float a = result->is_complex ? result->image[2 * i] : result->image[i];
        const float b = result->is_complex ? result->image[2 * i + 1] : 0.0f;
        before[count] = level->intensity[i];
        after[count++] = a * a + b * b;
    }
    if (count > 1) {
        double mean_before, mean_after, deviation_before, deviation_after;
        mean_and_deviation(before, count, &mean_before, &deviation_before);
        mean_and_deviation(after, count, &mean_after, &deviation_after);
        statistics->level_change_db = 10.0 * log10(mean_after / mean_before);
        statistics->input_contrast = deviation_before / mean_before;
        statistics->output_contrast = deviation_after / mean_after;
        statistics->correlation = correlation(before, after, count);
        status = histogram_distance(report, before, after, count, &statistics->histogram_distance);
    }
    free(before);
    return status;
}

static void fill_statistics(const struct tracer *tracer, const struct patch_level *level,
                            const struct echoes *echoes, double inject_s,
                            struct injection_result *result)
{
    sonject_statistics *statistics = &result->statistics;
    statistics->pings = tracer->counts.pings;
    statistics->rays = tracer->counts.rays;
    statistics->ray_queries = tracer->counts.queries;
    statistics->impulses = tracer->counts.impulses;
    statistics->trace_s = echoes->trace_s;
    statistics->form_s = echoes->form_s;
    statistics->inject_s = inject_s;
    statistics->noise_floor_db = 10.0 * log10(level->noise_ratio);
    statistics->seabed_lambert = view_seabed_lambert(&tracer->view, tracer->scene);
    statistics->noise_floor_source =
        !tracer->scene->injection.estimate_noise
            ? scene_key_source(tracer->scene, "injection.noise_floor")
            : (uint32_t)(level->measures_noise ? SONJECT_SOURCE_PATCH : SONJECT_SOURCE_FALLBACK);
    for (size_t i = 0; i < result->rows * result->columns; i++)
        statistics->changed_pixels += result->influence[i] != 0;
}

/* A scene on its patch, and what is asked of its echoes. */
struct prepared {
    struct injection_setup setup;
    struct image_match match;
    struct patch_request patch;
};

/* To be given to prepared_clear, also on failure. */
static sonject_status prepare(struct prepared *prepared, struct report *report,
                              struct device *device, const struct scene *scene,
                              const struct injection_input *input,
                              sonject_progress_function progress, void *user)
{
    struct injection_setup *setup = &prepared->setup;
    memset(prepared, 0, sizeof *prepared);
    sonject_status status = injection_setup_init(setup, report, device, scene, input);
    /* the grid follows the response */
    THEN(status, match_image(&setup->tracer, setup->pixels, input, &prepared->match));
    THEN(status, patch_request_init(&prepared->patch, &setup->tracer, setup->pixels,
                                    input->is_complex, progress, user));
    return status;
}

static void prepared_clear(struct prepared *prepared)
{
    patch_request_clear(&prepared->patch);
    injection_setup_clear(&prepared->setup);
}

sonject_status trace_other_response(struct tracer *tracer, const struct injection_input *input,
                                    const struct echo_request *request,
                                    const struct impulse_sink *sink)
{
    struct prepared traced;
    sonject_status status = prepare(&traced, tracer->report, tracer->device, input->traced, input,
                                    request->progress, request->user);
    THEN(status, check_response_fits(tracer, &traced.setup.tracer));
    THEN(status, trace_impulses(&traced.setup.tracer, &traced.patch.request, sink));
    tracer->counts = traced.setup.tracer.counts;
    prepared_clear(&traced);
    return status;
}

static sonject_status form_and_compose(struct prepared *prepared,
                                       const struct injection_input *input,
                                       struct injection_result *result)
{
    struct tracer *tracer = &prepared->setup.tracer;
    const float *pixels = prepared->setup.pixels;
    const struct image_match *match = &prepared->match;
    const struct patch_level *level = &prepared->patch.level;
    struct echoes echoes;
    prepared->patch.request.wants_coherent = match->looks > 1.0;
    sonject_status status =
        echoes_form(&echoes, tracer, &prepared->patch.request, input->traced ? input : NULL);
    const double start = clock_seconds();
    THEN(status, set_target_levels(tracer, &echoes, result));
    THEN(status, compose(tracer, match, level, &echoes, pixels, input->is_complex, result));
    if (status == SONJECT_OK && tracer->scene->injection.mode == SONJECT_MODE_RESYNTHESISE)
        status = compare_seabed(tracer->report, &echoes, level, result);
    THEN(status, find_truth(tracer, level, match, input, &echoes, result));
    if (status == SONJECT_OK) {
        tell_match(match, &tracer->response, &result->statistics);
        fill_statistics(tracer, level, &echoes, clock_seconds() - start, result);
        result->orders = echoes.orders;
        memcpy(result->order_energy, echoes.order_energy, sizeof result->order_energy);
        memset(echoes.order_energy, 0, sizeof echoes.order_energy); /* they are the result's now */
    }
    echoes_clear(&echoes);
    return status;
}

sonject_status injection_run(struct report *report, struct device *device,
                             const struct scene *scene, const struct injection_input *input,
                             sonject_progress_function progress, void *user,
                             struct injection_result *result)
{
    struct prepared prepared;
    memset(result, 0, sizeof *result);
    sonject_status status = prepare(&prepared, report, device, scene, input, progress, user);
    THEN(status, result_init(result, report, scene, input));
    THEN(status, form_and_compose(&prepared, input, result));
    if (status == SONJECT_OK)
        turn_back(&prepared.setup.tracer.view, result);
    prepared_clear(&prepared);
    if (status != SONJECT_OK)
        injection_result_clear(result);
    return status;
}

sonject_status injection_trace(struct report *report, struct device *device,
                               const struct scene *scene, const struct injection_input *input,
                               const struct impulse_sink *sink, sonject_progress_function progress,
                               void *user, struct trace_counts *counts)
{
    struct prepared prepared;
    sonject_status status = prepare(&prepared, report, device, scene, input, progress, user);
    THEN(status, trace_impulses(&prepared.setup.tracer, &prepared.patch.request, sink));
    *counts = prepared.setup.tracer.counts;
    prepared_clear(&prepared);
    return status;
}
