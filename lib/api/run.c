/* Runs on files: a scene's checks, its results, shards and stages. */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/elements.h>

#include "api/handles.h"
#include "dataset/run.h"

/* Begins a call that works on files and tells its progress. */
static sonject_status begin(sonject_context *context, struct run_request *request,
                            sonject_progress_function progress, void *user, int *was_finished)
{
    CHECK(context_begin_call(context));
    context_watch(context, &progress, &user);
    memset(request, 0, sizeof *request);
    request->progress = progress;
    request->user = user;
    if (was_finished)
        *was_finished = 0;
    return SONJECT_OK;
}

/* Takes the folder of the results, and the labels to be made. */
static sonject_status take_folder(struct report *report, struct run_request *request,
                                  const char *folder, uint32_t labels)
{
    if (!folder || !folder[0])
        return null_argument(report, "folder");
    if (labels & ~LABEL_FORMATS)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "labels must be a sum of sonject_labels");
    request->folder = folder;
    request->label_formats = labels;
    return SONJECT_OK;
}

static bool is_time(double seconds)
{
    return seconds >= 0.0 && isfinite(seconds);
}

static sonject_status check_shard(struct report *report, const sonject_run_params *params)
{
    const bool is_whole = params->shard_count == 0 && params->shard_index == 0;
    if (!is_whole && (params->shard_index < 1 || params->shard_index > params->shard_count ||
                      params->shard_count > SHARDS_MAX))
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "there is no shard %lu of %lu: shards are 1 to K, K at most %d",
                              (unsigned long)params->shard_index,
                              (unsigned long)params->shard_count, SHARDS_MAX);
    if (!is_whole && params->labels != 0)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "shards have no labels: ask sonject_merge for them");
    if (!is_time(params->exit_after_s) || !is_time(params->checkpoint_s))
        return report_failure(report, SONJECT_ERROR_ARGUMENT, "times are seconds, not below 0");
    return SONJECT_OK;
}

/* Runs the scene, with a calibration first if the scene asks for one. */
static sonject_status run_calibrated(sonject_context *context, const sonject_scene *handle,
                                     const struct run_request *asked, int *was_finished)
{
    struct run_request request = *asked;
    struct scene calibrated;
    struct report *report = &context->report;
    if (!request.scene->calibrates_itself)
        return run_scene(report, &context->device, &request, was_finished);
    sonject_status status =
        calibrated_scene_read(report, &handle->source, request.scene, &request, &calibrated);
    request.scene = &calibrated;
    THEN(status, run_scene(report, &context->device, &request, was_finished));
    scene_clear(&calibrated);
    return status;
}

sonject_status sonject_run(sonject_context *context, const sonject_scene *scene,
                           const sonject_run_params *params, sonject_progress_function progress,
                           void *user, int *was_finished)
{
    struct run_request request;
    sonject_run_params taken;
    CHECK(begin(context, &request, progress, user, was_finished));
    struct report *report = &context->report;
    if (!scene)
        return null_argument(report, "scene");
    CHECK(params_take(report, &taken, sizeof taken, params,
                      offsetof(sonject_run_params, shard_index), "run parameters"));
    CHECK(take_folder(report, &request, taken.folder, taken.labels));
    CHECK(check_shard(report, &taken));
    CHECK(scene_use(report, scene, &request.scene));
    request.source = &scene->source;
    request.shard = taken.shard_index;
    request.shards = taken.shard_count;
    request.exit_after_s = taken.exit_after_s;
    request.checkpoint_s = taken.checkpoint_s;
    request.overwrites = taken.overwrites != 0;
    return context_finish(context, run_calibrated(context, scene, &request, was_finished));
}

sonject_status sonject_merge(sonject_context *context, const sonject_scene *scene,
                             const sonject_merge_params *params, sonject_progress_function progress,
                             void *user, int *was_finished)
{
    struct run_request request;
    sonject_merge_params taken;
    CHECK(begin(context, &request, progress, user, was_finished));
    struct report *report = &context->report;
    CHECK(params_take(report, &taken, sizeof taken, params, sizeof taken, "merge parameters"));
    CHECK(take_folder(report, &request, taken.folder, taken.labels));
    request.merges = true;
    request.overwrites = true; /* the shards' runs have checked that they may */
    if (!scene)
        return context_finish(context,
                              merge_folder(report, &context->device, &request, was_finished));
    CHECK(scene_use(report, scene, &request.scene));
    return context_finish(context, run_calibrated(context, scene, &request, was_finished));
}

sonject_status sonject_trace(sonject_context *context, const sonject_scene *scene, const char *file,
                             sonject_progress_function progress, void *user)
{
    struct run_request request;
    CHECK(begin(context, &request, progress, user, NULL));
    struct report *report = &context->report;
    if (!file || !file[0])
        return null_argument(report, "file");
    CHECK(scene_use(report, scene, &request.scene));
    request.source = &scene->source;
    return context_finish(context, trace_scene(report, &context->device, &request, file));
}

sonject_status sonject_form(sonject_context *context, const sonject_scene *scene,
                            const sonject_form_params *params, sonject_progress_function progress,
                            void *user, int *was_finished)
{
    struct run_request request;
    sonject_form_params taken;
    const struct scene *used = NULL;
    CHECK(begin(context, &request, progress, user, was_finished));
    struct report *report = &context->report;
    CHECK(params_take(report, &taken, sizeof taken, params, sizeof taken, "form parameters"));
    if (!taken.file || !taken.file[0])
        return null_argument(report, "file and folder");
    CHECK(check_overrides(report, taken.file, taken.overrides, taken.override_count));
    CHECK(take_folder(report, &request, taken.folder, taken.labels));
    request.overwrites = taken.overwrites != 0;
    if (scene)
        CHECK(scene_use(report, scene, &used));
    return context_finish(
        context, form_scene(report, &context->device, used, &taken, &request, was_finished));
}

sonject_status sonject_elements_run(sonject_context *context, const sonject_scene *scene,
                                    const sonject_run_params *params,
                                    sonject_progress_function progress, void *user)
{
    struct run_request request;
    sonject_run_params taken;
    CHECK(begin(context, &request, progress, user, NULL));
    struct report *report = &context->report;
    if (!scene)
        return null_argument(report, "scene");
    CHECK(params_take(report, &taken, sizeof taken, params,
                      offsetof(sonject_run_params, shard_index), "run parameters"));
    CHECK(take_folder(report, &request, taken.folder, 0));
    if (taken.shard_index > 0 || taken.shard_count > 0 || taken.exit_after_s != 0.0 ||
        taken.checkpoint_s != 0.0)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "element data have no shards or checkpoints");
    CHECK(scene_use(report, scene, &request.scene));
    return context_finish(context, run_elements(report, &context->device, request.scene, &taken,
                                                request.progress, request.user));
}

sonject_status sonject_check(sonject_context *context, const sonject_scene *scene, char **text)
{
    const struct scene *used;
    BEGIN_MAKING(context, text);
    CHECK(scene_use(&context->report, scene, &used));
    return describe_scene(&context->report, used, text);
}

void sonject_text_release(char **text)
{
    if (!text)
        return;
    free(*text);
    *text = NULL;
}
