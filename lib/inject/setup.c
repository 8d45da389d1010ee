/* The layout of a scene on its patch, ready for rays. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/synthetic.h"
#include "inject/injection.h"
#include "scene/point_response.h"

struct raster_layout made_layout(const struct scene *scene)
{
    const sonject_synthetic_params *synthetic = &scene->synthetic;
    struct raster_layout layout = {0, 0, 1, PIXEL_FLOAT32};
    if (scene->input_kind == SONJECT_INPUT_SYNTHETIC) {
        layout.rows = synthetic->rows;
        layout.columns = synthetic->columns;
        layout.channels = synthetic->complex_pixels ? 2 : 1;
    } else if (scene->input_kind == SONJECT_INPUT_UNIFORM) {
        layout.rows = scene->uniform_rows;
        layout.columns = scene->uniform_columns;
    }
    return layout;
}

sonject_status make_input(struct report *report, const struct scene *scene,
                          struct injection_input *input)
{
    const sonject_synthetic_params *synthetic = &scene->synthetic;
    const bool is_synthetic = scene->input_kind == SONJECT_INPUT_SYNTHETIC;
    const double reference = scene_reference_speed(scene);
    const struct raster_layout layout = made_layout(scene);
    struct point_response response;
    memset(input, 0, sizeof *input);
    input->is_made = true;
    input->rows = (size_t)layout.rows;
    input->columns = (size_t)layout.columns;
    input->is_complex = layout.channels == 2;
    const size_t count = input->rows * input->columns;
    float *pixels = allocate_array(count, layout.channels * sizeof *pixels);
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

/* Checks the response: the coherent map's scale is known for one real cross-range response only. */
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

/* Finds the sonar's response on the patch. */
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
    view_turn_plane(&setup->tracer.view, input->rows, input->columns, setup->pixels, pixel_bytes);
    return SONJECT_OK;
}
