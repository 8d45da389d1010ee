/* sonject_merge: the result of all shards of a run, whose scene they keep. */
#include <stdlib.h>
#include <string.h>

#include <sonject/run.h>
#include <sonject/version.h>

#include "api/run_scene.h"
#include "base/file.h"
#include "dataset/earlier_result.h"
#include "dataset/merged_bands.h"
#include "inject/checkpoints.h"
#include "trace/sums_file.h"

void sonject_merge_params_init(sonject_merge_params *params)
{
    memset(params, 0, sizeof *params);
    params->struct_size = sizeof *params;
}

/* The scene that the first of the shards keeps. */
static sonject_status read_kept_scene(struct report *report, const struct sums_file *file,
                                      bool allows_user_shapes, struct scene *scene)
{
    sonject_form_params params;
    sonject_form_params_init(&params);
    params.file = file->path;
    params.allows_user_shapes = allows_user_shapes;
    if (strcmp(file->head.identity.version, sonject_version()) != 0)
        return refuse_foreign_sums(report, file->path, "another version of sonject");
    return read_traced_scene(report, &file->scene, &params, scene);
}

/* A run whose scene its shards keep. */
static sonject_status merge_kept(struct sonject_context *context, const struct run_request *asked,
                                 bool allows_user_shapes, int *was_finished)
{
    struct report *report = &context->report;
    struct run_request of_kept = *asked;
    struct run_request *request = &of_kept;
    struct sums_folder folder;
    struct scene scene;
    scene_init(&scene);
    char *work = checkpoints_folder(request->folder);
    CHECK_MEMORY(report, work, "a file name");
    sonject_status status = sums_folder_read(&folder, report, work, 0, SIZE_MAX, false);
    const bool is_merged =
        status == SONJECT_OK && folder.count == 0 && folder_has_result(request->folder);
    if (status == SONJECT_OK && folder.count == 0 && !is_merged)
        status =
            report_failure(report, SONJECT_ERROR_INPUT,
                           "%s: holds no shards of a run, and there is no campaign: run them with "
                           "--shard I/K first",
                           work);
    if (status == SONJECT_OK && !is_merged)
        status = read_kept_scene(report, &folder.files[0], allows_user_shapes, &scene);
    sums_folder_clear(&folder);
    request->scene = &scene;
    if (is_merged)
        status = earlier_check_merged(report, request->folder, request->label_formats);
    if (is_merged && was_finished)
        *was_finished = status == SONJECT_OK;
    if (status == SONJECT_OK && !is_merged)
        status = run_scene(context, request, was_finished);
    scene_clear(&scene);
    free(work);
    return status;
}

/* Each of the names, one a line, in its folder; *was_finished is 1 if all were. */
static sonject_status merge_bands(struct sonject_context *context, const struct run_request *asked,
                                  bool allows_user_shapes, const char *names, int *was_finished)
{
    struct report *report = &context->report;
    bool were_finished = true;
    sonject_status status = check_bands_begun(report, asked->folder, names);
    while (status == SONJECT_OK && *names) {
        int was_band_finished = 0;
        struct run_request of_band = *asked;
        char *band = take_band(&names);
        char *folder = band ? path_join(asked->folder, band) : NULL;
        of_band.folder = folder;
        status = folder ? merge_kept(context, &of_band, allows_user_shapes, &was_band_finished)
                        : report_out_of_memory(report, "a file name");
        were_finished = were_finished && was_band_finished;
        free(band);
        free(folder);
    }
    if (was_finished)
        *was_finished = status == SONJECT_OK && were_finished;
    return status;
}

/* A run in the folder, or those of bands in folders below it. */
static sonject_status merge_folder(struct sonject_context *context,
                                   const struct run_request *request, bool allows_user_shapes,
                                   int *was_finished)
{
    char *bands;
    CHECK(find_bands(&context->report, request->folder, &bands));
    sonject_status status =
        *bands ? merge_bands(context, request, allows_user_shapes, bands, was_finished)
               : merge_kept(context, request, allows_user_shapes, was_finished);
    free(bands);
    return status;
}

sonject_status sonject_merge(sonject_context *context, const sonject_scene *scene,
                             const sonject_merge_params *params, sonject_progress_function progress,
                             void *user, int *was_finished)
{
    if (!context)
        return SONJECT_ERROR_ARGUMENT;
    context_begin_call(context);
    context_watch(context, &progress, &user);
    sonject_merge_params taken;
    sonject_merge_params_init(&taken);
    CHECK(params_take(&context->report, &taken, sizeof taken, params, sizeof taken,
                      "merge parameters"));
    if (!taken.folder || !taken.folder[0])
        return null_argument(&context->report, "folder");
    struct run_request request;
    memset(&request, 0, sizeof request);
    request.folder = taken.folder;
    if (taken.labels & ~LABEL_FORMATS)
        return report_failure(&context->report, SONJECT_ERROR_ARGUMENT,
                              "labels must be a sum of sonject_labels");
    request.label_formats = taken.labels;
    request.merges = true;
    request.overwrites = true; /* the shards were asked whether they may */
    request.progress = progress;
    request.user = user;
    if (was_finished)
        *was_finished = 0;
    if (!scene)
        return merge_folder(context, &request, taken.allows_user_shapes != 0, was_finished);
    CHECK(scene_use(&context->report, scene, &request.scene));
    return run_scene(context, &request, was_finished);
}
