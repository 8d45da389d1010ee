#include "inject/injection_setup.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/synthetic.h"
#include "scene/patch_view.h"
#include "scene/point_response.h"

static sonject_status make_synthetic(struct report *report, const struct scene *scene,
                                     struct injection_input *input)
{
    const sonject_synthetic_params *synthetic = &scene->synthetic;
    const double reference = scene_reference_speed(scene);
    struct point_response response;
    point_response_init(&response, &scene->sonar, reference, scene->geometry.row_spacing_m);
    input->is_complex = synthetic->complex_pixels != 0;
    float *pixels = allocate_array((size_t)synthetic->rows * synthetic->columns,
                                   (input->is_complex ? 2 : 1) * sizeof *pixels);
    CHECK_MEMORY(report, pixels, "the synthetic seabed");
    const sonject_status status =
        synthesise_seabed(report, synthetic, &scene->geometry, response.resolution_m,
                          reference / (2.0 * scene->sonar.bandwidth_hz), pixels);
    if (status != SONJECT_OK)
        free(pixels);
    else
        input->pixels = pixels;
    return status;
}

sonject_status make_input(struct report *report, const struct scene *scene,
                          struct injection_input *input)
{
    memset(input, 0, sizeof *input);
    input->is_made = true;
    if (scene->input_kind == SONJECT_INPUT_SYNTHETIC) {
        input->rows = scene->synthetic.rows;
        input->columns = scene->synthetic.columns;
        return make_synthetic(report, scene, input);
    }
    input->rows = scene->uniform_rows;
    input->columns = scene->uniform_columns;
    const size_t count = input->rows * input->columns;
    float *pixels = allocate_array(count, sizeof *pixels);
    CHECK_MEMORY(report, pixels, "the uniform seabed");
    for (size_t i = 0; i < count; i++)
        pixels[i] = 1.0f;
    input->pixels = pixels;
    return SONJECT_OK;
}

void flip_rows(void *plane, size_t rows, size_t row_bytes, char *scratch)
{
    char *bytes = plane;
    for (size_t row = 0; row < rows / 2; row++) {
        char *a = bytes + row * row_bytes;
        char *b = bytes + (rows - 1 - row) * row_bytes;
        memcpy(scratch, a, row_bytes);
        memcpy(a, b, row_bytes);
        memcpy(b, scratch, row_bytes);
    }
}

/* Reflectivity of unit mean square for the coherent map: the pixels over the root of the level. */
static float *coherent_plane(const struct patch_level *level, const float *pixels, size_t count,
                             size_t part)
{
    float *plane = allocate_array(count, sizeof *plane);
    for (size_t i = 0; plane && i < count; i++)
        plane[i] = pixels[2 * i + part] / sqrtf(level->level[i]);
    return plane;
}

void patch_request_clear(struct patch_request *patch)
{
    free(patch->real_part);
    free(patch->imaginary_part);
    patch_level_clear(&patch->level);
}

sonject_status patch_request_init(struct patch_request *patch, struct tracer *tracer,
                                  const float *pixels, bool is_complex,
                                  sonject_progress_function progress, void *user)
{
    const struct scene *scene = tracer->scene;
    const size_t count = tracer->view.rows * tracer->view.columns;
    const bool resynthesises = scene->injection.mode == SONJECT_MODE_RESYNTHESISE;
    const bool is_coherent = resynthesises && scene->seabed.map == SONJECT_MAP_COHERENT;
    memset(patch, 0, sizeof *patch);
    CHECK(patch_level_init(&patch->level, tracer->report, scene, &tracer->view, &tracer->response,
                           pixels, is_complex));
    patch->real_part = is_coherent ? coherent_plane(&patch->level, pixels, count, 0) : NULL;
    patch->imaginary_part = is_coherent ? coherent_plane(&patch->level, pixels, count, 1) : NULL;
    patch->request.map = patch->level.map;
    patch->request.field = is_coherent     ? SEABED_FIELD_COHERENT
                           : resynthesises ? SEABED_FIELD_SPECKLE
                                           : SEABED_FIELD_NONE;
    patch->request.reflectivity_real = patch->real_part;
    patch->request.reflectivity_imaginary = patch->imaginary_part;
    patch->request.progress = progress;
    patch->request.user = user;
    if (!is_coherent || (patch->real_part && patch->imaginary_part))
        return SONJECT_OK;
    patch_request_clear(patch);
    return report_out_of_memory(tracer->report, "the reflectivity");
}

static sonject_status check_combination(struct report *report, const struct scene *scene,
                                        bool is_complex)
{
    if (scene->injection.mode == SONJECT_MODE_RESYNTHESISE &&
        scene->seabed.map == SONJECT_MAP_COHERENT && !is_complex)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the coherent seabed map needs a complex image: use map: intensity "
                              "or despeckled");
    if (scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE &&
        (scene->injection.mode != SONJECT_MODE_RESYNTHESISE || scene->sonar.transducer_side_m <= 0))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the brute force estimator needs mode: resynthesise and a transducer "
                              "that rays can hit: give its side");
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
    free(setup->scratch);
}

static sonject_status copy_pixels(struct injection_setup *setup, struct report *report,
                                  const struct injection_input *input)
{
    const size_t row_bytes = input->columns * (input->is_complex ? 2 : 1) * sizeof(float);
    setup->scratch = allocate_array(input->columns, 2 * sizeof(float));
    setup->pixels = allocate_array(input->rows, row_bytes);
    if (!setup->scratch || !setup->pixels)
        return report_out_of_memory(report, "the patch");
    memcpy(setup->pixels, input->pixels, input->rows * row_bytes);
    if (setup->tracer.view.is_mirrored)
        flip_rows(setup->pixels, input->rows, row_bytes, setup->scratch);
    return SONJECT_OK;
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
    CHECK(injection_setup_init_scene(setup, report, device, scene, input));
    return copy_pixels(setup, report, input);
}
