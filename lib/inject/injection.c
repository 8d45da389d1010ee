#include "inject/injection.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/report.h"
#include "base/system/process.h"
#include "inject/accuracy.h"
#include "inject/compose.h"
#include "inject/windows.h"
#include "scene/point_response.h"
#include "trace/checkpoint.h"

/* A scene laid out on its patch, with all that tracing needs. */
struct prepared {
    struct injection_setup setup;
    struct image_match match;
    struct patch_facts facts;
    struct influence_windows windows;
};

/* Compares the resynthesised seabed with the measured one where no object is in view: the numbers
 * of the paper's Figure 5. */
static sonject_status compare_seabed(struct report *report, const struct echoes *echoes,
                                     const struct patch_level *level,
                                     const struct injected_window *result,
                                     sonject_statistics *statistics)
{
    const size_t pixels = result->at.rows * result->at.columns;
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

static void fill_statistics(const struct prepared *prepared, struct injection_result *result)
{
    const struct tracer *tracer = &prepared->setup.tracer;
    sonject_statistics *statistics = &result->statistics;
    tell_match(&prepared->match, tracer, statistics);
    result->ceiling = prepared->match.ceiling;
    statistics->pings = tracer->counts.pings;
    statistics->rays = tracer->counts.rays;
    statistics->ray_queries = tracer->counts.queries;
    statistics->impulses = tracer->counts.impulses;
    statistics->noise_floor_db = 10.0 * log10(prepared->facts.noise_ratio);
    statistics->seabed_lambert = tracer->view.seabed_lambert;
    statistics->noise_floor_source =
        !tracer->scene->injection.estimate_noise
            ? scene_key_source(tracer->scene, "injection.noise_floor")
            : (uint32_t)(prepared->facts.measures_noise ? SONJECT_SOURCE_PATCH
                                                        : SONJECT_SOURCE_FALLBACK);
}

/* Prepares a scene. The caller gives it to prepared_clear, also on failure. */
static sonject_status prepare(struct prepared *prepared, struct report *report,
                              struct device *device, const struct scene *scene,
                              const struct injection_input *input)
{
    struct injection_setup *setup = &prepared->setup;
    struct tracer *tracer = &setup->tracer;
    memset(prepared, 0, sizeof *prepared);
    sonject_status status = injection_setup_init(setup, report, device, scene, input);
    /* The match comes first, since the grid follows the response. */
    THEN(status, match_image(tracer, setup->pixels, input, &prepared->match));
    THEN(status, patch_facts_init(&prepared->facts, report, scene, &tracer->view, setup->pixels,
                                  input->is_complex));
    THEN(status, influence_windows_find(&prepared->windows, tracer, input->is_whole));
    return status;
}

static void prepared_clear(struct prepared *prepared)
{
    influence_windows_clear(&prepared->windows);
    injection_setup_clear(&prepared->setup);
}

/* The request for the echoes in a window. */
struct window_job {
    struct tracer tracer; /* sees the window alone */
    struct patch_request patch;
    struct progress_share progress; /* the window's share of the run's progress */
};

/* Sets up the tracing of a window. On success the caller gives the job to window_job_clear; on
 * failure nothing is held. */
static sonject_status window_job_init(struct window_job *job, struct prepared *prepared,
                                      const struct influence_windows *windows, size_t number,
                                      bool is_complex, sonject_progress_function progress,
                                      void *user)
{
    const struct patch_view *view = &prepared->setup.tracer.view;
    const struct influence_window *window = &windows->list[number];
    const double share = 1.0 / (double)windows->count;
    job->tracer = prepared->setup.tracer;
    job->tracer.view = patch_view_window(view, &window->at);
    job->tracer.follows = window->follows;
    job->progress = (struct progress_share){progress, user, (double)number * share, share};
    return patch_request_init(&job->patch, &job->tracer, view, &prepared->facts,
                              prepared->setup.pixels, is_complex, progress_share_tell,
                              &job->progress);
}

static void window_job_clear(struct window_job *job, struct prepared *prepared)
{
    prepared->setup.tracer.counts = job->tracer.counts;
    patch_request_clear(&job->patch);
}

static sonject_status end_tracing(struct tracer *tracer)
{
    return tracer->checkpoint ? checkpoint_finish(tracer->checkpoint, &tracer->counts) : SONJECT_OK;
}

/* Returns the patch's pixels in a window, for free(); NULL where memory is out. */
static float *pixels_in_window(const struct prepared *prepared, const struct window *at,
                               bool is_complex)
{
    const size_t parts = is_complex ? 2 : 1;
    float *pixels = allocate_array(at->rows, at->columns * parts * sizeof *pixels);
    for (size_t row = 0; pixels && row < at->rows; row++)
        memcpy(pixels + row * at->columns * parts,
               prepared->setup.pixels +
                   parts * ((at->first_row + row) * prepared->setup.tracer.view.columns +
                            at->first_column),
               at->columns * parts * sizeof *pixels);
    return pixels;
}

static sonject_status compose_window(struct prepared *prepared, struct window_job *job,
                                     const struct window *at, const bool *is_empty,
                                     struct echoes *echoes, struct injection_result *result)
{
    struct tracer *tracer = &job->tracer;
    struct injected_window *window = &result->windows[result->window_count++];
    const bool is_complex = result->is_complex;
    float *pixels = pixels_in_window(prepared, at, is_complex);
    CHECK_MEMORY(tracer->report, pixels, "the patch");
    sonject_status status =
        injected_window_init(window, tracer->report, at, is_complex, result->objects);
    THEN(status, set_target_levels(tracer, echoes, window));
    THEN(status,
         compose(tracer, &prepared->match, &job->patch.level, echoes, pixels, is_complex, window));
    if (status == SONJECT_OK && tracer->scene->injection.mode == SONJECT_MODE_RESYNTHESISE)
        status =
            compare_seabed(tracer->report, echoes, &job->patch.level, window, &result->statistics);
    THEN(status, find_truth(tracer, &job->patch.level, &prepared->match, is_empty + at->first_row,
                            echoes, window));
    free(pixels);
    CHECK(status);
    for (uint32_t i = 0; i < result->object_count; i++)
        if (tracer_follows(tracer, i))
            object_truth_move(&result->objects[i], at);
    result->orders = echoes->orders;
    memcpy(window->order_energy, echoes->order_energy, sizeof window->order_energy);
    memset(echoes->order_energy, 0, sizeof echoes->order_energy); /* the window owns them now */
    return SONJECT_OK;
}

/* Traces a window, by the rays of another response where `traced` is another. Composes the formed
 * echoes into the result, unless a checkpoint cut the tracing short. */
static sonject_status inject_window(struct prepared *prepared, struct prepared *traced,
                                    const struct influence_windows *windows, size_t number,
                                    const bool *is_empty, sonject_progress_function progress,
                                    void *user, struct injection_result *result)
{
    struct window_job job, other;
    struct echoes echoes;
    const bool is_other = traced != prepared;
    CHECK(window_job_init(&job, prepared, windows, number, result->is_complex, progress, user));
    struct window_job *source = is_other ? &other : &job;
    job.patch.request.wants_coherent = prepared->match.looks > 1.0;
    sonject_status status = is_other ? window_job_init(&other, traced, windows, number,
                                                       result->is_complex, progress, user)
                                     : SONJECT_OK;
    if (status != SONJECT_OK) {
        window_job_clear(&job, prepared);
        return status;
    }
    if (is_other)
        status = check_response_fits(&job.tracer, &other.tracer);
    if (is_other && status == SONJECT_OK && number == 0)
        note_other_aspects(&job.tracer, &other.tracer);
    THEN(status, echoes_form(&echoes, &job.tracer, &job.patch.request, &source->tracer,
                             &source->patch.request));
    if (status == SONJECT_OK) {
        const double start = clock_seconds();
        result->statistics.trace_s += echoes.trace_s;
        result->statistics.form_s += echoes.form_s;
        if (!checkpoint_is_cut_short(source->tracer.checkpoint))
            status = compose_window(prepared, &job, &windows->list[number].at, is_empty, &echoes,
                                    result);
        result->statistics.inject_s += clock_seconds() - start;
        echoes_clear(&echoes);
    }
    if (is_other)
        window_job_clear(&other, traced);
    window_job_clear(&job, prepared);
    return status;
}

/* Marks the view's rows where nothing was heard; for free(), NULL where memory is out. */
static bool *find_empty_rows(const struct patch_view *view, const struct injection_input *input)
{
    bool *is_empty = allocate_array(view->rows, sizeof *is_empty);
    for (uint64_t i = 0; is_empty && input->empty && i < input->empty->count; i++) {
        const size_t row = (size_t)(input->empty->numbers[i] - (uint64_t)input->first_row);
        is_empty[view->is_mirrored ? view->rows - 1 - row : row] = true;
    }
    return is_empty;
}

static sonject_status inject_windows(struct prepared *prepared, struct prepared *traced,
                                     const struct injection_input *input,
                                     sonject_progress_function progress, void *user,
                                     struct injection_result *result)
{
    struct tracer *tracer = &traced->setup.tracer;
    bool *is_empty = find_empty_rows(&tracer->view, input);
    CHECK_MEMORY(tracer->report, is_empty, "the truth");
    sonject_status status = injection_result_init(result, &prepared->setup.tracer,
                                                  traced->windows.count, input->is_complex);
    for (size_t i = 0; status == SONJECT_OK && i < traced->windows.count; i++)
        status =
            inject_window(prepared, traced, &traced->windows, i, is_empty, progress, user, result);
    free(is_empty);
    THEN(status, end_tracing(tracer));
    prepared->setup.tracer.counts = tracer->counts;
    return status;
}

static sonject_status run(struct report *report, struct device *device, const struct scene *scene,
                          const struct injection_input *input, sonject_progress_function progress,
                          void *user, struct injection_result *result)
{
    struct prepared prepared, other;
    struct prepared *traced = input->traced ? &other : &prepared;
    memset(result, 0, sizeof *result);
    memset(&other, 0, sizeof other);
    sonject_status status = prepare(&prepared, report, device, scene, input);
    if (status == SONJECT_OK && input->traced)
        status = prepare(&other, report, device, input->traced, input);
    THEN(status, inject_windows(&prepared, traced, input, progress, user, result));
    if (status == SONJECT_OK) {
        /* Paste into the patch's own pixels, which keep every bit where nothing changes them. */
        result->image = prepared.setup.pixels;
        prepared.setup.pixels = NULL;
        for (size_t i = 0; i < result->window_count; i++)
            injection_result_paste(result, &result->windows[i]);
        fill_statistics(&prepared, result);
        result->statistics.ray_scale = traced->setup.tracer.scene->injection.ray_scale;
        injection_result_turn_back(result, &prepared.setup.tracer.view);
    }
    prepared_clear(&prepared);
    prepared_clear(&other);
    if (status != SONJECT_OK)
        injection_result_clear(result);
    return status;
}

sonject_status injection_run(struct report *report, struct device *device,
                             const struct scene *scene, const struct injection_input *input,
                             sonject_progress_function progress, void *user,
                             struct injection_result *result)
{
    struct injection_input with = *input;
    struct pilots own;
    memset(result, 0, sizeof *result);
    CHECK(pilots_find(&own, report, device, &scene, &with, progress, user));
    const sonject_status status = run(report, device, scene, &with, progress, user, result);
    /* The pilots' echoes are not formed with another response. */
    if (status == SONJECT_OK && with.pilots && !input->traced)
        result->statistics.energy_error = pilots_error_of(with.pilots, result);
    pilots_clear(&own);
    return status;
}

sonject_status injection_trace(struct report *report, struct device *device,
                               const struct scene *scene, const struct injection_input *input,
                               sonject_progress_function progress, void *user)
{
    struct prepared prepared;
    sonject_status status = prepare(&prepared, report, device, scene, input);
    for (size_t i = 0; status == SONJECT_OK && i < prepared.windows.count; i++) {
        struct window_job job;
        status = window_job_init(&job, &prepared, &prepared.windows, i, input->is_complex, progress,
                                 user);
        if (status == SONJECT_OK) {
            status = trace_impulses(&job.tracer, &job.patch.request, NULL);
            window_job_clear(&job, &prepared);
        }
    }
    THEN(status, end_tracing(&prepared.setup.tracer));
    prepared_clear(&prepared);
    return status;
}
