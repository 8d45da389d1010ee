#include "inject/injection.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "image/statistics.h"
#include "inject/compose.h"
#include "inject/echoes.h"
#include "inject/patch_level.h"
#include "inject/truth.h"
#include "scene/cross_range.h"

sonject_status injection_check(struct report *report, const struct scene *scene, double first_row,
                               double first_column, size_t rows, size_t columns,
                               struct water *water, struct patch_view *view,
                               struct placements *placements)
{
    sonject_status status = scene_lay_water(scene, report, water);
    if (status == SONJECT_OK)
        status =
            patch_view_init(view, report, scene, water, first_row, first_column, rows, columns);
    if (status == SONJECT_OK)
        status = placements_init(placements, report, scene, view, first_row, first_column);
    return status;
}

void injection_result_clear(struct injection_result *result)
{
    free(result->image);
    free(result->field);
    free(result->energy);
    for (int i = 0; i < SCENE_INTERACTIONS_MAX; i++)
        free(result->order_energy[i]);
    free(result->visibility);
    free(result->highlight);
    free(result->shadow);
    free(result->labels);
    free(result->influence);
    free(result->objects);
    memset(result, 0, sizeof *result);
}

static sonject_status result_init(struct injection_result *result, struct report *report,
                                  const struct scene *scene, const struct injection_input *input)
{
    const size_t pixels = input->rows * input->columns;
    memset(result, 0, sizeof *result);
    result->rows = input->rows;
    result->columns = input->columns;
    result->is_complex = input->is_complex;
    result->object_count = scene->object_count;
    result->image = allocate_array(pixels, (input->is_complex ? 2 : 1) * sizeof(float));
    result->field = allocate_array(pixels, 2 * sizeof(float));
    result->energy = allocate_array(pixels, sizeof(float));
    result->visibility = allocate_array(pixels, sizeof(float));
    result->highlight = allocate_array(pixels, 1);
    result->shadow = allocate_array(pixels, 1);
    result->labels = allocate_array(pixels, 1);
    result->influence = allocate_array(pixels, 1);
    result->objects = allocate_array(scene->object_count, sizeof *result->objects);
    if (!result->image || !result->field || !result->energy || !result->visibility ||
        !result->highlight || !result->shadow || !result->labels || !result->influence ||
        !result->objects) {
        injection_result_clear(result);
        return report_out_of_memory(report, "the result");
    }
    return SONJECT_OK;
}

/* Reverses the order of rows in place; scratch holds one row. */
static void flip_rows(void *plane, size_t rows, size_t row_bytes, char *scratch)
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

static void flip_box(sonject_box *box, size_t rows)
{
    if (box->rows > 0)
        box->first_row = rows - box->first_row - box->rows;
}

/* From the mirrored view back into the image's row order. */
static void unmirror(struct injection_result *result, char *scratch)
{
    const size_t rows = result->rows;
    const size_t columns = result->columns;
    flip_rows(result->image, rows, columns * (result->is_complex ? 2 : 1) * sizeof(float), scratch);
    flip_rows(result->field, rows, columns * 2 * sizeof(float), scratch);
    flip_rows(result->energy, rows, columns * sizeof(float), scratch);
    for (uint32_t i = 0; i < result->orders; i++)
        flip_rows(result->order_energy[i], rows, columns * sizeof(float), scratch);
    flip_rows(result->visibility, rows, columns * sizeof(float), scratch);
    flip_rows(result->highlight, rows, columns, scratch);
    flip_rows(result->shadow, rows, columns, scratch);
    flip_rows(result->labels, rows, columns, scratch);
    flip_rows(result->influence, rows, columns, scratch);
    for (uint32_t i = 0; i < result->object_count; i++) {
        sonject_object_truth *truth = &result->objects[i];
        truth->row = (double)(rows - 1) - truth->row;
        truth->along_track_m = -truth->along_track_m;
        flip_box(&truth->highlight, rows);
        flip_box(&truth->shadow, rows);
        flip_box(&truth->both, rows);
    }
}

/* The numbers of the paper's Figure 5: how the resynthesised seabed compares with the measured one
 * where no object is in view. */
static sonject_status compare_seabed(struct report *report, const struct echoes *echoes,
                                     const struct patch_level *level,
                                     struct injection_result *result)
{
    const size_t pixels = result->rows * result->columns;
    float *before = allocate_array(pixels, sizeof *before);
    float *after = allocate_array(pixels, sizeof *after);
    size_t count = 0;
    sonject_status status =
        before && after ? SONJECT_OK : report_out_of_memory(report, "the comparison");
    for (size_t i = 0; status == SONJECT_OK && i < pixels; i++) {
        if (echoes->lost_energy[i] > 1e-3f * echoes->seabed_energy[i] ||
            echoes->target_energy[i] > 1e-3f * echoes->seabed_energy[i])
            continue;
        const float a = result->is_complex ? result->image[2 * i] : result->image[i];
        const float b = result->is_complex ? result->image[2 * i + 1] : 0.0f;
        before[count] = level->intensity[i];
        after[count++] = a * a + b * b;
    }
    if (status == SONJECT_OK && count > 1) {
        sonject_statistics *statistics = &result->statistics;
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
    free(after);
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
    for (size_t i = 0; i < result->rows * result->columns; i++)
        statistics->changed_pixels += result->influence[i] != 0;
}

/* The energies of each order become the result's. */
static void hand_over_orders(struct echoes *echoes, struct injection_result *result)
{
    result->orders = echoes->orders;
    for (uint32_t i = 0; i < echoes->orders; i++) {
        result->order_energy[i] = echoes->order_energy[i];
        echoes->order_energy[i] = NULL;
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

static sonject_status trace_and_compose(struct tracer *tracer, const float *pixels, bool is_complex,
                                        sonject_progress_function progress, void *user,
                                        struct injection_result *result)
{
    const struct scene *scene = tracer->scene;
    const size_t count = tracer->view.rows * tracer->view.columns;
    const bool resynthesises = scene->injection.mode == SONJECT_MODE_RESYNTHESISE;
    const bool is_coherent = resynthesises && scene->seabed.map == SONJECT_MAP_COHERENT;
    struct patch_level level;
    struct echoes echoes;
    struct echo_request request;
    memset(&request, 0, sizeof request);
    sonject_status status = patch_level_init(&level, tracer->report, scene, &tracer->view,
                                             &tracer->response, pixels, is_complex);
    if (status != SONJECT_OK)
        return status;
    float *real_part = is_coherent ? coherent_plane(&level, pixels, count, 0) : NULL;
    float *imaginary_part = is_coherent ? coherent_plane(&level, pixels, count, 1) : NULL;
    request.map = level.map;
    request.field = is_coherent     ? SEABED_FIELD_COHERENT
                    : resynthesises ? SEABED_FIELD_SPECKLE
                                    : SEABED_FIELD_NONE;
    request.reflectivity_real = real_part;
    request.reflectivity_imaginary = imaginary_part;
    request.progress = progress;
    request.user = user;
    if (is_coherent && (!real_part || !imaginary_part))
        status = report_out_of_memory(tracer->report, "the reflectivity");
    else
        status = echoes_compute(&echoes, tracer, &request);
    if (status == SONJECT_OK) {
        const double start = clock_seconds();
        status = compose(tracer, &level, &echoes, pixels, is_complex, result);
        if (status == SONJECT_OK && resynthesises)
            status = compare_seabed(tracer->report, &echoes, &level, result);
        if (status == SONJECT_OK) {
            find_truth(tracer, &level, &echoes, result);
            fill_statistics(tracer, &level, &echoes, clock_seconds() - start, result);
            hand_over_orders(&echoes, result);
        }
        echoes_clear(&echoes);
    }
    free(real_part);
    free(imaginary_part);
    patch_level_clear(&level);
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
    if (scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE &&
        (scene->injection.mode != SONJECT_MODE_RESYNTHESISE || scene->sonar.transducer_side_m <= 0))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the brute force estimator needs mode: resynthesise and a transducer "
                              "that rays can hit: give its side");
    return SONJECT_OK;
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

sonject_status injection_run(struct report *report, struct device *device,
                             const struct scene *scene, const struct injection_input *input,
                             sonject_progress_function progress, void *user,
                             struct injection_result *result)
{
    memset(result, 0, sizeof *result);
    struct placements placements = {NULL, 0, NULL, 0, NULL};
    struct water water = {NULL, 0, 0.0};
    struct tracer tracer;
    memset(&tracer, 0, sizeof tracer);
    tracer.report = report;
    tracer.device = device;
    tracer.scene = scene;
    sonject_status status = check_combination(report, scene, input->is_complex);
    if (status == SONJECT_OK)
        status = injection_check(report, scene, input->first_row, input->first_column, input->rows,
                                 input->columns, &water, &tracer.view, &placements);
    tracer.placements = placements.parts;
    tracer.part_count = placements.part_count;
    tracer.objects = placements.objects;
    tracer.relief = placements.relief;
    if (status == SONJECT_OK && scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE &&
        !tracer.view.water.is_straight)
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "the brute force estimator follows straight rays only: use connect "
                                "where layers of water bend them");
    if (status == SONJECT_OK)
        status = result_init(result, report, scene, input);
    if (status == SONJECT_OK) {
        const size_t row_bytes = input->columns * (input->is_complex ? 2 : 1) * sizeof(float);
        const double reference = tracer.view.range_ratio * water.straight_speed_mps;
        /* a row of the widest layer, the field */
        char *scratch = allocate_array(input->columns, 2 * sizeof(float));
        float *pixels = allocate_array(input->rows, row_bytes);
        result->statistics.level_change_db = NAN;
        result->statistics.input_contrast = NAN;
        result->statistics.output_contrast = NAN;
        result->statistics.histogram_distance = NAN;
        result->statistics.correlation = NAN;
        result->statistics.struct_size = sizeof result->statistics;
        status = scratch && pixels ? point_response_of_scene(&tracer.response, report, scene,
                                                             &tracer.view, reference)
                                   : report_out_of_memory(report, "the patch");
        if (status == SONJECT_OK)
            status = cross_range_check(&tracer.response, report, scene, &tracer.view);
        if (status == SONJECT_OK)
            status = check_coherent_map(&tracer);
        if (status == SONJECT_OK) {
            memcpy(pixels, input->pixels, input->rows * row_bytes);
            if (tracer.view.is_mirrored)
                flip_rows(pixels, input->rows, row_bytes, scratch);
            status = trace_and_compose(&tracer, pixels, input->is_complex, progress, user, result);
        }
        if (status == SONJECT_OK && tracer.view.is_mirrored)
            unmirror(result, scratch);
        free(scratch);
        free(pixels);
    }
    placements_clear(&placements);
    water_clear(&water);
    if (status != SONJECT_OK)
        injection_result_clear(result);
    return status;
}
