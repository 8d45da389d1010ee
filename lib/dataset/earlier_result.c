/* Results of earlier calls in a folder. */
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "dataset/run.h"
#include "inject/checkpoints.h"

#define DIFFERENCES_NAMED 4

sonject_status earlier_document(struct report *report, const char *folder, const char *name,
                                json_t **document)
{
    char path[PATH_CAPACITY];
    *document = NULL;
    CHECK(path_in(report, path, folder, "%s", name));
    if (!file_exists(path))
        return SONJECT_OK;
    const sonject_status status = json_document_read(report, path, document);
    if (status != SONJECT_ERROR_INPUT)
        return status;
    report->message[0] = '\0';
    return SONJECT_OK;
}

static bool has_document(const char *folder, const char *name)
{
    struct report ignored = {.host = NULL};
    char path[PATH_CAPACITY];
    return path_in(&ignored, path, folder, "%s", name) == SONJECT_OK && file_exists(path);
}

bool folder_has_result(const char *folder)
{
    return has_document(folder, RUN_DOCUMENT);
}

/* The number of differences, and the names of the first ones. */
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
        add_difference(&differences, "inputs that it does not record", NULL, NULL);
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

/* Compares a result's inputs with the call's, the image's file among them. */
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

/* Returns whether a result was begun in the folder, whose files lie there without its document. */
static bool has_work(const char *folder)
{
    char *work = checkpoints_folder(folder);
    const bool has = work && file_exists(work);
    free(work);
    return has;
}

/* Refuses a folder with another's file where the call would write its own. The document is looked
 * for again, since a process that writes the same result may have ended meanwhile. */
static sonject_status check_others(struct report *report, const struct earlier_request *request)
{
    if (request->overwrites || has_work(request->folder))
        return SONJECT_OK;
    char path[PATH_CAPACITY];
    for (size_t i = 0; request->names[i]; i++) {
        CHECK(path_in(report, path, request->folder, "%s", request->names[i]));
        CHECK(file_check_replaced(report, path));
        if (file_exists(path) && !has_document(request->folder, request->document))
            return report_failure(
                report, SONJECT_ERROR_ARGUMENT,
                "%s: holds the file %s, but no %s that tells of it: choose another "
                "folder, or replace that file (--overwrite)",
                request->folder, request->names[i], request->document);
    }
    return SONJECT_OK;
}

sonject_status earlier_check(struct report *report, const struct earlier_request *request,
                             bool *is_finished)
{
    const char *changed = NULL;
    bool is_same = false;
    *is_finished = false;
    if (!has_document(request->folder, request->document))
        return check_others(report, request);
    json_t *document;
    sonject_status status = earlier_document(report, request->folder, request->document, &document);
    THEN(status, check_inputs(report, request, document, &is_same));
    if (status == SONJECT_OK && is_same)
        status = file_list_check(json_object_get(document, "files"), report, request->folder,
                                 request->hashes_all, &changed);
    if (status == SONJECT_OK && changed)
        report_log(report, "%s: %s is not as it was written: the result is made again",
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
        status = input_failure(report, folder,
                               "is already merged, without those labels: run its scene into this "
                               "folder again, with them");
    else if (status == SONJECT_OK && changed)
        status = input_failure(report, folder,
                               "is already merged, but %s is not as it was written: run its scene "
                               "into this folder again",
                               changed);
    json_decref(document);
    return status;
}

json_t *earlier_withdraw(const char *folder, const char *document)
{
    struct report ignored = {.host = NULL};
    json_t *earlier = NULL;
    earlier_document(&ignored, folder, document, &earlier);
    json_t *files = json_incref(json_object_get(earlier, "files"));
    char path[PATH_CAPACITY];
    if (path_in(&ignored, path, folder, "%s", document) == SONJECT_OK)
        file_discard(path);
    json_decref(earlier);
    char *work = checkpoints_folder(folder);
    if (work)
        (void)folder_make_one(work);
    free(work);
    return files;
}

void earlier_tidy(const char *folder, const char *document, json_t *earlier, const json_t *files)
{
    char *work = has_document(folder, document) ? checkpoints_folder(folder) : NULL;
    if (work)
        folder_discard(work);
    free(work);
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
