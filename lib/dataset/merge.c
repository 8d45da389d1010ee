/* sonject_merge: the result of all shards of a run, whose scene they keep. */
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/file.h"
#include "dataset/earlier_result.h"
#include "dataset/run.h"
#include "inject/checkpoints.h"
#include "trace/sums_file.h"

/* The scene that the first of the shards keeps. */
static sonject_status read_kept_scene(struct report *report, const struct sums_file *file,
                                      bool allows_user_shapes, struct scene *scene)
{
    sonject_form_params params;
    memset(&params, 0, sizeof params);
    params.file = file->path;
    params.allows_user_shapes = allows_user_shapes;
    if (strcmp(file->head.identity.version, sonject_version()) != 0)
        return refuse_foreign_sums(report, file->path, "another version of sonject");
    return read_traced_scene(report, &file->scene, &params, scene);
}

/* A run whose scene its shards keep. */
static sonject_status merge_kept(struct report *report, struct device_slot *slot,
                                 const struct run_request *asked, bool allows_user_shapes,
                                 int *was_finished)
{
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
        status = run_scene(report, slot, request, was_finished);
    scene_clear(&scene);
    free(work);
    return status;
}

/* Each of the names, one a line, in its folder; *was_finished is 1 if all were. */
static sonject_status merge_bands(struct report *report, struct device_slot *slot,
                                  const struct run_request *asked, bool allows_user_shapes,
                                  const char *names, int *was_finished)
{
    bool were_finished = true;
    sonject_status status = check_bands_begun(report, asked->folder, names);
    while (status == SONJECT_OK && *names) {
        int was_band_finished = 0;
        struct run_request of_band = *asked;
        char *band = take_band(&names);
        char *folder = band ? path_join(asked->folder, band) : NULL;
        of_band.folder = folder;
        status = folder ? merge_kept(report, slot, &of_band, allows_user_shapes, &was_band_finished)
                        : report_out_of_memory(report, "a file name");
        were_finished = were_finished && was_band_finished;
        free(band);
        free(folder);
    }
    if (was_finished)
        *was_finished = status == SONJECT_OK && were_finished;
    return status;
}

sonject_status merge_folder(struct report *report, struct device_slot *slot,
                            const struct run_request *request, bool allows_user_shapes,
                            int *was_finished)
{
    char *bands;
    CHECK(find_bands(report, request->folder, &bands));
    sonject_status status =
        *bands ? merge_bands(report, slot, request, allows_user_shapes, bands, was_finished)
               : merge_kept(report, slot, request, allows_user_shapes, was_finished);
    free(bands);
    return status;
}
