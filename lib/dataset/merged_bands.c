#include "dataset/merged_bands.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/folder.h"
#include "base/growing_text.h"
#include "base/memory.h"
#include "dataset/earlier_result.h"
#include "inject/checkpoints.h"
#include "schema/scene_bands.h"
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

/* The bands of a scene that was traced with this one chosen; nothing where another was, or none. */
static sonject_status list_kept(struct report *report, const struct kept_scene *kept,
                                const char *band, char **names)
{
    bool is_chosen = false;
    size_t count = 0;
    if (!kept->text)
        return SONJECT_OK;
    const char **others = allocate_array(kept->override_count, sizeof *others);
    CHECK_MEMORY(report, others, "the names of bands");
    for (size_t i = 0; i < kept->override_count; i++)
        if (strncmp(kept->overrides[i], CHOICE, strlen(CHOICE)) == 0)
            is_chosen = strcmp(kept->overrides[i] + strlen(CHOICE), band) == 0;
        else
            others[count++] = kept->overrides[i];
    struct scene_text source;
    memset(&source, 0, sizeof source);
    source.path = kept->path;
    source.text = kept->text;
    source.bytes = strlen(kept->text);
    source.overrides = others;
    source.override_count = count;
    const sonject_status status = is_chosen ? scene_text_bands(report, &source, names) : SONJECT_OK;
    free(others);
    return status;
}

/* From the scene that the band's shards keep. */
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

sonject_status find_bands(struct report *report, const char *folder, char **names)
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

char *take_band(const char **names)
{
    const size_t length = strcspn(*names, "\n");
    char *name = allocate_array(length + 1, 1);
    if (name)
        memcpy(name, *names, length);
    *names += length + ((*names)[length] == '\n');
    return name;
}

sonject_status check_bands_begun(struct report *report, const char *folder, const char *names)
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
