#include "inject/injection.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/report.h"
#include "image/statistics.h"
#include "inject/compose.h"
#include "inject/echoes.h"
#include "inject/injection_setup.h"
#include "inject/match.h"
#include "inject/patch_level.h"
#include "inject/traced_impulses.h"
#include "inject/truth.h"

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
    result->statistics.level_change_db = NAN;
    result->statistics.input_contrast = NAN;
    result->statistics.output_contrast = NAN;
    result->statistics.histogram_distance = NAN;
    result->statistics.correlation = NAN;
    result->statistics.struct_size = sizeof result->statistics;
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

static sonject_status form_and_compose(struct injection_setup *setup,
                                       const struct injection_input *input,
                                       const struct impulse_source *source,
                                       sonject_progress_function progress, void *user,
                                       struct injection_result *result)
{
    struct tracer *tracer = &setup->tracer;
    const float *pixels = setup->pixels;
    const bool is_complex = input->is_complex;
    const bool resynthesises = tracer->scene->injection.mode == SONJECT_MODE_RESYNTHESISE;
    struct patch_request patch;
    struct image_match match;
    struct echoes echoes;
    sonject_status status = match_image(tracer, pixels, input, &match);
    THEN(status, patch_request_init(&patch, tracer, pixels, is_complex, progress, user));
    if (status != SONJECT_OK)
        return status;
    patch.request.wants_coherent = match.looks > 1.0;
    status = echoes_form(&echoes, tracer, &patch.request, source);
    if (status == SONJECT_OK) {
        const double start = clock_seconds();
        status = set_target_levels(tracer, &echoes, result);
        THEN(status, compose(tracer, &match, &patch.level, &echoes, pixels, is_complex, result));
        if (status == SONJECT_OK && resynthesises)
            status = compare_seabed(tracer->report, &echoes, &patch.level, result);
        if (status == SONJECT_OK) {
            status = find_truth(tracer, &patch.level, &match.seabed, &echoes, result);
            tell_match(&match, &tracer->response, &result->statistics);
            fill_statistics(tracer, &patch.level, &echoes, clock_seconds() - start, result);
            hand_over_orders(&echoes, result);
        }
        echoes_clear(&echoes);
    }
    patch_request_clear(&patch);
    return status;
}

sonject_status injection_form(struct report *report, struct device *device,
                              const struct scene *scene, const struct injection_input *input,
                              const struct impulse_source *source,
                              sonject_progress_function progress, void *user,
                              struct injection_result *result)
{
    struct injection_setup setup;
    memset(result, 0, sizeof *result);
    sonject_status status = injection_setup_init(&setup, report, device, scene, input);
    THEN(status, result_init(result, report, scene, input));
    THEN(status, form_and_compose(&setup, input, source, progress, user, result));
    if (status == SONJECT_OK && setup.tracer.view.is_mirrored)
        unmirror(result, setup.scratch);
    injection_setup_clear(&setup);
    if (status != SONJECT_OK)
        injection_result_clear(result);
    return status;
}

sonject_status injection_run(struct report *report, struct device *device,
                             const struct scene *scene, const struct injection_input *input,
                             sonject_progress_function progress, void *user,
                             struct injection_result *result)
{
    const struct impulse_source source = traced_impulses();
    return injection_form(report, device, scene, input, &source, progress, user, result);
}

sonject_status injection_trace(struct report *report, struct device *device,
                               const struct scene *scene, const struct injection_input *input,
                               const struct impulse_sink *sink, sonject_progress_function progress,
                               void *user, struct trace_counts *counts)
{
    struct injection_setup setup;
    struct image_match match;
    struct patch_request patch;
    sonject_status status = injection_setup_init(&setup, report, device, scene, input);
    if (status == SONJECT_OK) /* the grid follows the response */
        status = match_image(&setup.tracer, setup.pixels, input, &match);
    THEN(status, patch_request_init(&patch, &setup.tracer, setup.pixels, input->is_complex,
                                    progress, user));
    if (status == SONJECT_OK) {
        status = trace_impulses(&setup.tracer, &patch.request, sink);
        *counts = setup.tracer.counts;
        patch_request_clear(&patch);
    }
    injection_setup_clear(&setup);
    return status;
}
