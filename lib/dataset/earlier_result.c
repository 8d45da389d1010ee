#include "dataset/earlier_result.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/file_list.h"
#include "base/folder.h"
#include "base/growing_text.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "dataset/run_files.h"
#include "inject/checkpoints.h"
#include "schema/scene_bands.h"
#include "schema/scene_file.h"
#include "trace/sums_file.h"

#define DIFFERENCES_NAMED 4
#define CHOICE            "band=" /* the override that chooses a band */

sonject_status earlier_document(struct report *report, const char *folder, const char *name,
                                json_t **document)
{
    char *path = path_join(folder, name);
    *document = NULL;
    sonject_status status = path ? SONJECT_OK : report_out_of_memory(report, "a file name");
    if (status == SONJECT_OK && file_exists(path))
        status = json_document_read(report, path, document);
    if (status == SONJECT_ERROR_INPUT) {
        report->message[0] = '\0';
        status = SONJECT_OK;
    }
    free(path);
    return status;
}

static bool has_document(const char *folder, const char *name)
{
    char *path = path_join(folder, name);
    const bool is_there = path && file_exists(path);
    free(path);
    return is_there;
}

bool folder_has_result(const char *folder)
{
    return has_document(folder, RUN_DOCUMENT);
}

/* What differs, the first of it by name. */
struct differences {
    size_t count;
    struct growing_text text;
};

static void add_difference(struct differences *differences, const char *name, const json_t *there,
                           const json_t *here)
{
    if (differences->count++ >= DIFFERENCES_NAMED)
        return;
    growing_text_add(&differences->text, "%s%s", differences->count > 1 ? ", " : "", name);
    if (json_is_integer(there) && json_is_integer(here))
        growing_text_add(&differences->text, " (%lld there, %lld here)",
                         (long long)json_integer_value(there), (long long)json_integer_value(here));
}

sonject_status inputs_check(struct report *report, const char *folder, const json_t *there,
                            const json_t *here, const char *image, bool overwrites, bool *is_same)
{
    struct differences differences = {0, {NULL, 0, 0, false}};
    const char *name;
    json_t *value;
    if (!json_is_object(there))
        add_difference(&differences, "inputs that it does not tell", NULL, NULL);
    json_object_foreach((json_t *)here, name, value)
    {
        if (there && !json_equal(json_object_get(there, name), value))
            add_difference(&differences, name, json_object_get(there, name), value);
    }
    json_object_foreach((json_t *)there, name, value)
    {
        if (!json_object_get(here, name))
            add_difference(&differences, name, value, NULL);
    }
    if (image)
        add_difference(&differences, image, NULL, NULL);
    char *names = growing_text_end(&differences.text);
    sonject_status status = SONJECT_OK;
    *is_same = differences.count == 0;
    if (!*is_same && !overwrites)
        status = names ? report_failure(report, SONJECT_ERROR_ARGUMENT,
                                        "%s: holds another result, which differs in %s%s: choose "
                                        "another folder, or replace that result (--overwrite)",
                                        folder, names,
                                        differences.count > DIFFERENCES_NAMED ? ", ..." : "")
                       : report_out_of_memory(report, "inputs");
    free(names);
    return status;
}

/* Whether a result is of the call's inputs, the image's file among them. */
static sonject_status check_inputs(struct report *report, const struct earlier_request *request,
                                   const json_t *document, bool *is_same)
{
    const json_t *image = json_object_get(document, "input_file");
    const char *name = json_string_value(json_object_get(image, "name"));
    const char *path = request->scene->input_path;
    const bool is_elsewhere = !name || !path || strcmp(name, path) != 0;
    bool holds = true;
    if (path) {
        CHECK(file_entry_holds(report, image, path, request->hashes_all || is_elsewhere, &holds));
    }
    return inputs_check(report, request->folder, json_object_get(document, "inputs"),
                        request->inputs, holds ? NULL : path, request->overwrites, is_same);
}

sonject_status earlier_check(struct report *report, const struct earlier_request *request,
                             bool *is_finished)
{
    const char *changed = NULL;
    bool is_same = false;
    *is_finished = false;
    if (!has_document(request->folder, request->document))
        return SONJECT_OK;
    json_t *document;
    sonject_status status = earlier_document(report, request->folder, request->document, &document);
    THEN(status, check_inputs(report, request, document, &is_same));
    if (status == SONJECT_OK && is_same)
        status = file_list_check(json_object_get(document, "files"), report, request->folder,
                                 request->hashes_all, &changed);
    if (status == SONJECT_OK && changed)
        report_news(report, "%s: %s is not as it was written: the result is made again",
                    request->folder, changed);
    *is_finished = status == SONJECT_OK && is_same && !changed &&
                   (request->label_formats & ~labels_of_document(document)) == 0;
    json_decref(document);
    return status;
}

sonject_status earlier_check_merged(struct report *report, const char *folder,
                                    uint32_t label_formats)
{
    const char *changed = NULL;
    json_t *document;
    sonject_status status = earlier_document(report, folder, RUN_DOCUMENT, &document);
    const bool lacks_labels = (label_formats & ~labels_of_document(document)) != 0;
    THEN(status,
         file_list_check(json_object_get(document, "files"), report, folder, true, &changed));
    if (status == SONJECT_OK && lacks_labels)
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s: is merged already, without those labels: run its scene into "
                                "it once more with them",
                                folder);
    else if (status == SONJECT_OK && changed)
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s: is merged already, but %s is not as it was written: run its "
                                "scene into it once more",
                                folder, changed);
    json_decref(document);
    return status;
}

json_t *earlier_withdraw(const char *folder, const char *document)
{
    struct report ignored = {{0}, NULL, NULL};
    json_t *earlier = NULL;
    earlier_document(&ignored, folder, document, &earlier);
    json_t *files = json_incref(json_object_get(earlier, "files"));
    char *path = path_join(folder, document);
    if (path)
        file_discard(path);
    json_decref(earlier);
    free(path);
    return files;
}

void earlier_tidy(const char *folder, json_t *earlier, const json_t *files)
{
    file_list_discard(earlier, files, folder);
    folder_tidy(folder);
    json_decref(earlier);
}

sonject_status earlier_describe(struct report *report, json_t **document, json_t *inputs,
                                json_t *files, const struct scene *scene)
{
    json_t *image = NULL;
    sonject_status status = SONJECT_OK;
    if (scene->input_path)
        status = file_entry(report, scene->input_path, scene->input_path, true, &image);
    json_add(document, "inputs", json_incref(inputs));
    json_add(document, "input_file", image ? image : json_null());
    json_add(document, "files", json_incref(files));
    return status;
}

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
