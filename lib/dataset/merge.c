/* The result of all shards of a run, whose scene the shards keep. Each of several bands has a
 * folder of the band's name. */
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/file.h"
#include "dataset/run.h"
#include "inject/checkpoints.h"
#include "schema/scene_file.h"
#include "trace/sums_file.h"

/* Finds the number of shards that the work in a folder names; 0: there is no work. */
static sonject_status count_shards(struct report *report, const char *folder, uint64_t *shards)
{
    char *work = checkpoints_folder(folder);
    const sonject_status status = work ? sums_folder_shards(report, work, 0, shards)
                                       : report_out_of_memory(report, "a file name");
    free(work);
    return status;
}

/* Reads the scene that the first shard keeps. */
static sonject_status read_kept_scene(struct report *report, const struct sums_file *file,
                                      const char *folder, struct scene *scene)
{
    char calibration[PATH_CAPACITY];
    sonject_form_params params;
    memset(&params, 0, sizeof params);
    params.file = file->path;
    if (strcmp(file->head.identity.version, sonject_version()) != 0)
        return refuse_foreign_sums(report, file->path, "another version of sonject");
    CHECK(path_in(report, calibration, folder, CALIBRATION_NAME ".yaml"));
    return read_traced_scene(report, &file->scene, &params,
                             file_exists(calibration) ? calibration : NULL, scene);
}

/* Merges a run whose scene the shards keep. */
static sonject_status merge_kept(struct report *report, struct device_slot *slot,
                                 const struct run_request *asked, int *was_finished)
{
    struct run_request request = *asked;
    struct sums_folder folder;
    struct scene scene;
    char *work = checkpoints_folder(asked->folder);
    CHECK_MEMORY(report, work, "a file name");
    scene_init(&scene);
    sonject_status status = sums_folder_read(&folder, report, work, 0, SIZE_MAX, false);
    const bool has_shards = status == SONJECT_OK && folder.count > 0;
    if (has_shards)
        status = read_kept_scene(report, &folder.files[0], asked->folder, &scene);
    sums_folder_clear(&folder);
    request.scene = &scene;
    if (has_shards) {
        THEN(status, run_scene(report, slot, &request, was_finished));
    } else if (status == SONJECT_OK && folder_has_result(asked->folder)) {
        status = earlier_check_merged(report, asked->folder, asked->label_formats);
        if (was_finished)
            *was_finished = status == SONJECT_OK;
    } else if (status == SONJECT_OK) {
        status = input_failure(
            report, work,
            "holds no shards of a run and no campaign: run the shards with --shard I/K first");
    }
    scene_clear(&scene);
    free(work);
    return status;
}

/* Finds whether the folder of a band holds shards, or that band's result. */
static sonject_status find_band(struct report *report, const char *folder, const char *band,
                                char path[PATH_CAPACITY], bool *is_there)
{
    uint64_t shards;
    json_t *document;
    CHECK(path_in(report, path, folder, "%s", band));
    CHECK(count_shards(report, path, &shards));
    CHECK(earlier_document(report, path, RUN_DOCUMENT, &document));
    const char *own = json_string_value(json_object_get(document, "band"));
    *is_there = shards > 0 || (own && strcmp(own, band) == 0);
    json_decref(document);
    return SONJECT_OK;
}

/* Checks that all bands are there that the result of one band names. Errors: INPUT (one is not
 * there), STORAGE, MEMORY. */
static sonject_status check_bands(struct report *report, const char *folder, const char *merged)
{
    size_t i;
    const json_t *name;
    json_t *document;
    char path[PATH_CAPACITY];
    sonject_status status = SONJECT_OK;
    CHECK(earlier_document(report, merged, RUN_DOCUMENT, &document));
    json_array_foreach(json_object_get(document, "bands"), i, name)
    {
        const char *band = json_string_value(name);
        bool is_there = true;
        if (band && is_band_name(band))
            THEN(status, find_band(report, folder, band, path, &is_there));
        if (!is_there)
            THEN(status,
                 input_failure(report, folder,
                               "holds no shards of band %s: run its shards with --shard I/K first",
                               band));
    }
    json_decref(document);
    return status;
}

sonject_status merge_folder(struct report *report, struct device_slot *slot,
                            const struct run_request *request, int *was_finished)
{
    uint64_t shards;
    struct folder_names below;
    char path[PATH_CAPACITY];
    size_t bands = 0;
    int were_finished = 1;
    CHECK(count_shards(report, request->folder, &shards));
    if (shards > 0 || folder_has_result(request->folder))
        return merge_kept(report, slot, request, was_finished);
    CHECK(folder_names_read(&below, report, request->folder, ""));
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < below.count; i++) {
        int was_band_finished = 0;
        bool is_there = false;
        struct run_request of_band = *request;
        of_band.folder = path;
        if (is_band_name(below.names[i]))
            status = find_band(report, request->folder, below.names[i], path, &is_there);
        if (!is_there)
            continue;
        THEN(status, merge_kept(report, slot, &of_band, &was_band_finished));
        if (bands++ == 0)
            THEN(status, check_bands(report, request->folder, path));
        were_finished = were_finished && was_band_finished;
    }
    folder_names_clear(&below);
    if (bands == 0)
        THEN(status, merge_kept(report, slot, request, was_finished));
    else if (was_finished)
        *was_finished = status == SONJECT_OK && were_finished;
    return status;
}
