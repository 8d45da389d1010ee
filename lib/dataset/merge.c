/* The result of all shards of a run, whose scene they keep; of several bands each in a folder of
 * its name. */
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/file.h"
#include "base/memory.h"
#include "dataset/earlier_result.h"
#include "dataset/run.h"
#include "inject/checkpoints.h"
#include "schema/scene_file.h"
#include "trace/sums_file.h"

#define CHOICE "band=" /* the override that chooses a band */

/* How many shards the work in a folder speaks of; 0: there is none. */
static sonject_status count_shards(struct report *report, const char *folder, uint64_t *shards)
{
    char *work = checkpoints_folder(folder);
    const sonject_status status = work ? sums_folder_shards(report, work, 0, shards)
                                       : report_out_of_memory(report, "a file name");
    free(work);
    return status;
}

/* The bands of the scene that the band's shards keep, where they were traced with this one chosen.
 */
static sonject_status list_kept(struct report *report, const struct kept_scene *kept,
                                const char *band, char **names)
{
    bool is_chosen = false;
    struct scene_text source;
    memset(&source, 0, sizeof source);
    if (!kept->text)
        return SONJECT_OK;
    const char **others = allocate_array(kept->override_count, sizeof *others);
    CHECK_MEMORY(report, others, "the names of bands");
    for (size_t i = 0; i < kept->override_count; i++)
        if (strncmp(kept->overrides[i], CHOICE, strlen(CHOICE)) == 0)
            is_chosen = strcmp(kept->overrides[i] + strlen(CHOICE), band) == 0;
        else
            others[source.override_count++] = kept->overrides[i];
    source.path = kept->path;
    source.text = kept->text;
    source.bytes = strlen(kept->text);
    source.overrides = others;
    const sonject_status status = is_chosen ? scene_text_bands(report, &source, names) : SONJECT_OK;
    free(others);
    return status;
}

static sonject_status find_in_shards(struct report *report, const char *folder, const char *band,
                                     char **names)
{
    struct sums_folder first;
    char *work = checkpoints_folder(folder);
    CHECK_MEMORY(report, work, "a file name");
    sonject_status status = sums_folder_read(&first, report, work, 0, 1, false);
    if (status == SONJECT_OK && first.count > 0)
        status = list_kept(report, &first.files[0].scene, band, names);
    sums_folder_clear(&first);
    free(work);
    return status;
}

/* From the band's run.json. */
static sonject_status find_in_result(struct report *report, const char *folder, const char *band,
                                     char **names)
{
    struct growing_text text = {NULL, 0, 0, false};
    size_t i;
    const json_t *name;
    json_t *document;
    CHECK(earlier_document(report, folder, RUN_DOCUMENT, &document));
    const char *own = json_string_value(json_object_get(document, "band"));
    const bool is_of_band = own && strcmp(own, band) == 0;
    if (is_of_band) {
        json_array_foreach(json_object_get(document, "bands"), i, name)
        {
            if (json_is_string(name) && is_band_name(json_string_value(name)))
                growing_text_add(&text, "%s\n", json_string_value(name));
        }
        *names = growing_text_end(&text);
    }
    json_decref(document);
    return is_of_band && !*names ? report_out_of_memory(report, "the names of bands") : SONJECT_OK;
}

/* The names of all bands of the scene of which a folder below this one, which has a band's name,
 * holds shards or a result: one a line, for free(); "" where there is none, or where this folder
 * itself holds a run. Errors: INPUT, STORAGE, MEMORY. */
static sonject_status find_bands(struct report *report, const char *folder, char **names)
{
    struct folder_names below;
    uint64_t shards;
    *names = NULL;
    sonject_status status = count_shards(report, folder, &shards);
    THEN(status, folder_names_read(&below, report, folder, ""));
    if (status != SONJECT_OK)
        return status;
    const bool is_run = shards > 0 || folder_has_result(folder);
    for (size_t i = 0; status == SONJECT_OK && !is_run && !*names && i < below.count; i++) {
        if (!is_band_name(below.names[i]))
            continue;
        char *path = path_join(folder, below.names[i]);
        status = path ? find_in_shards(report, path, below.names[i], names)
                      : report_out_of_memory(report, "a file name");
        if (status == SONJECT_OK && !*names)
            status = find_in_result(report, path, below.names[i], names);
        free(path);
    }
    folder_names_clear(&below);
    if (status == SONJECT_OK && !*names)
        *names = copy_text("");
    return status == SONJECT_OK && !*names ? report_out_of_memory(report, "the names of bands")
                                           : status;
}

/* The next of the names, for free(); NULL where memory is out. There must be one. */
static char *take_band(const char **names)
{
    const size_t length = strcspn(*names, "\n");
    char *name = allocate_array(length + 1, 1);
    if (name)
        memcpy(name, *names, length);
    *names += length + ((*names)[length] == '\n');
    return name;
}

/* Whether there is a shard or a result of each. Errors: INPUT (names one that has none), STORAGE,
 * MEMORY. */
static sonject_status check_bands_begun(struct report *report, const char *folder,
                                        const char *names)
{
    sonject_status status = SONJECT_OK;
    while (status == SONJECT_OK && *names) {
        uint64_t shards = 0;
        char *band = take_band(&names);
        char *path = band ? path_join(folder, band) : NULL;
        status = path ? count_shards(report, path, &shards)
                      : report_out_of_memory(report, "a file name");
        if (status == SONJECT_OK && shards == 0 && !folder_has_result(path))
            status = report_failure(report, SONJECT_ERROR_INPUT,
                                    "%s: holds no shards of band %s: run them with --shard I/K "
                                    "first",
                                    folder, band);
        free(band);
        free(path);
    }
    return status;
}

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
