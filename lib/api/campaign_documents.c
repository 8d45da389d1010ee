#include "api/campaign_documents.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "api/earlier_result.h"
#include "base/file.h"
#include "base/file_list.h"
#include "base/growing_text.h"
#include "base/json_document.h"

#define DOCUMENT "dataset.json"

/* The documents that are the same for every folder. */
static const char *const documents[] = {"classes.txt", "contact_sheet.png", "report.html"};

#define DOCUMENTS (sizeof documents / sizeof *documents)

static void discard(const struct data_set *set, const char *name)
{
    char *path = path_join(set->folder, name);
    if (path)
        file_discard(path);
    free(path);
}

void data_set_remove(const struct data_set *set)
{
    discard(set, DOCUMENT);
    for (size_t i = 0; i < DOCUMENTS; i++)
        discard(set, documents[i]);
    discard(set, "times.json");
    for (size_t i = 0; i < set->split_count; i++)
        split_folders_remove(set->folder, set->split_names[i]);
    discard(set, "campaign.json");
}

sonject_status data_set_is_finished(const struct data_set *set, bool *is_finished)
{
    const char *changed = NULL;
    json_t *document;
    sonject_status status = earlier_document(set->report, set->folder, DOCUMENT, &document);
    const json_t *files = json_object_get(document, "files");
    THEN(status, file_list_check(files, set->report, set->folder, true, &changed));
    *is_finished = status == SONJECT_OK && !changed &&
                   json_array_size(files) == DOCUMENTS + set->split_count &&
                   strcmp(member_text(document, "hash"), member_text(set->head, "hash")) == 0;
    json_decref(document);
    return status;
}

/* Ids that are missing, as ranges while they fit. */
struct missing {
    uint64_t count, first, last; /* of the range that is being found */
    size_t ranges;
    struct growing_text text;
};

#define RANGES_TOLD 12

static void tell_range(struct missing *missing)
{
    if (missing->ranges++ == RANGES_TOLD)
        growing_text_add(&missing->text, ", ...");
    if (missing->ranges > RANGES_TOLD)
        return;
    growing_text_add(&missing->text, "%s%" PRIu64, missing->ranges > 1 ? ", " : "", missing->first);
    if (missing->last > missing->first)
        growing_text_add(&missing->text, "-%" PRIu64, missing->last);
}

static void add_missing(struct missing *missing, uint64_t id)
{
    if (missing->count > 0 && id == missing->last + 1) {
        missing->last = id;
    } else {
        if (missing->count > 0)
            tell_range(missing);
        missing->first = missing->last = id;
    }
    missing->count++;
}

static sonject_status check_complete(const struct data_set *set)
{
    struct missing missing;
    char *changed = NULL;
    sonject_status status = SONJECT_OK;
    memset(&missing, 0, sizeof missing);
    for (size_t i = 0; status == SONJECT_OK && i < set->split_count; i++)
        for (uint64_t k = 0; status == SONJECT_OK && k < set->split_images[i]; k++) {
            bool has = false;
            status = data_set_has_image(set, i, set->split_first[i] + k, &changed, &has);
            if (status == SONJECT_OK && !has)
                add_missing(&missing, set->split_first[i] + k);
        }
    if (missing.count > 0)
        tell_range(&missing);
    char *ids = growing_text_end(&missing.text);
    if (status == SONJECT_OK && missing.count > 0)
        status = report_failure(set->report, SONJECT_ERROR_INPUT,
                                "%s: %llu of %llu images are missing%s: %s%s%s; run the campaign "
                                "or its shards again",
                                set->folder, (unsigned long long)missing.count,
                                (unsigned long long)set->images, changed ? " or changed" : "",
                                ids ? ids : "", changed ? "; not as it was written: " : "",
                                changed ? changed : "");
    free(changed);
    free(ids);
    return status;
}

/* Size and hash of the documents of splits and of those of the whole. */
static sonject_status list_documents(const struct data_set *set, json_t **files)
{
    char name[SPLIT_NAME_CAPACITY + 16];
    sonject_status status = SONJECT_OK;
    *files = json_array();
    for (size_t i = 0; status == SONJECT_OK && i < set->split_count; i++) {
        snprintf(name, sizeof name, "%s/coco.json", set->split_names[i]);
        status = file_list_add(files, set->report, set->folder, name, false);
    }
    for (size_t i = 0; status == SONJECT_OK && i < DOCUMENTS; i++)
        status = file_list_add(files, set->report, set->folder, documents[i], false);
    return status;
}

/* What the whole is: the last document, so a folder with dataset.json is complete. */
static sonject_status write_data_set(const struct data_set *set)
{
    json_t *files = NULL;
    char *path = path_join(set->folder, DOCUMENT);
    sonject_status status =
        path ? list_documents(set, &files) : report_out_of_memory(set->report, "a file name");
    json_t *document = json_object();
    static const char *const kept[] = {"sonject", "hash",   "device",  "images",  "rows",
                                       "columns", "splits", "classes", "outputs", "swaths"};
    for (size_t i = 0; i < sizeof kept / sizeof *kept; i++)
        json_add(&document, kept[i], json_incref(json_object_get(set->head, kept[i])));
    json_add(&document, "files", files);
    if (status == SONJECT_OK)
        status = json_document_write(set->report, document, 9, path);
    else
        json_decref(document);
    free(path);
    return status;
}

/* YOLO numbers classes by their lines in here. */
static sonject_status write_classes(const struct data_set *set)
{
    size_t i;
    const json_t *name;
    struct growing_text text = {NULL, 0, 0, false};
    char *path = path_join(set->folder, "classes.txt");
    CHECK_MEMORY(set->report, path, "classes.txt");
    json_array_foreach(json_object_get(set->head, "classes"), i, name)
    {
        growing_text_add(&text, "%s\n", json_string_value(name) ? json_string_value(name) : "");
    }
    const sonject_status status = growing_text_write(set->report, &text, path);
    free(path);
    return status;
}

sonject_status data_set_finish(struct data_set *set)
{
    sonject_status status = check_complete(set);
    THEN(status, write_data_set_coco(set));
    THEN(status, write_classes(set));
    THEN(status, write_contact_sheet(set));
    THEN(status, write_report_page(set));
    THEN(status, write_data_set(set));
    if (status != SONJECT_OK)
        return status;
    for (size_t i = 0; i < set->split_count; i++)
        split_folders_tidy(set->folder, set->split_names[i], set->outputs);
    folder_tidy(set->folder);
    return SONJECT_OK;
}
