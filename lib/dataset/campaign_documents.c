/* The documents of a whole data set; COCO documents of splits are put together image by image. */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/file.h"
#include "base/file_list.h"
#include "base/growing_text.h"
#include "base/json_document.h"
#include "dataset/campaign_documents.h"
#include "dataset/earlier_result.h"
#include "dataset/labels.h"

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

/* A document in the making: annotations wait in a file of their own until all images are told. */
struct coco_file {
    const struct data_set *set;
    size_t split;
    FILE *images, *annotations;
    uint64_t annotation_count;
};

/* Adds a document, which is given up, to a list in a file. */
static sonject_status add_entry(const struct data_set *set, FILE *file, json_t *entry,
                                bool is_first)
{
    char *text = json_document_text(entry, JSON_COMPACT | JSON_REAL_PRECISION(9));
    json_decref(entry);
    CHECK_MEMORY(set->report, text, "coco.json");
    const bool failed = fprintf(file, "%s%s", is_first ? "\n" : ",\n", text) < 0;
    free(text);
    return failed ? file_failure(set->report, set->folder, "write coco.json below", errno)
                  : SONJECT_OK;
}

/* An annotation of an image's record, numbered. Takes it by reference. */
static json_t *numbered(struct coco_file *coco, uint64_t image, const json_t *annotation)
{
    json_t *copy = json_copy((json_t *)annotation);
    coco->annotation_count++;
    json_add(&copy, "id", json_integer((json_int_t)coco->annotation_count));
    json_add(&copy, "image_id", json_integer((json_int_t)image));
    return copy;
}

static sonject_status add_image(struct coco_file *coco, uint64_t id, bool is_first)
{
    json_t *record;
    size_t i;
    const json_t *annotation;
    const struct data_set *set = coco->set;
    CHECK(data_set_image(set, coco->split, id, &record, NULL, NULL));
    sonject_status status = add_entry(
        set, coco->images,
        coco_image(id, member_text(record, "image"), (uint64_t)set->rows, (uint64_t)set->columns),
        is_first);
    json_array_foreach(json_object_get(record, "annotations"), i, annotation)
    {
        const bool is_first_of_all = coco->annotation_count == 0;
        THEN(status,
             add_entry(set, coco->annotations, numbered(coco, id, annotation), is_first_of_all));
    }
    json_decref(record);
    return status;
}

static sonject_status add_images(struct coco_file *coco)
{
    const struct data_set *set = coco->set;
    sonject_status status = SONJECT_OK;
    for (uint64_t k = 0; status == SONJECT_OK && k < set->split_images[coco->split]; k++) {
        const double fraction = (double)(set->split_first[coco->split] + k) / (double)set->images;
        if (set->progress && set->progress(set->user, fraction, "documents") != 0)
            return report_failure(set->report, SONJECT_CANCELLED, "cancelled");
        status = add_image(coco, set->split_first[coco->split] + k, k == 0);
    }
    return status;
}

/* rewind() would forget that what it still had to write did not fit on the disk. */
static bool copy_all(FILE *from, FILE *to)
{
    char bytes[65536];
    size_t count;
    if (fflush(from) != 0 || fseek(from, 0, SEEK_SET) != 0)
        return false;
    while ((count = fread(bytes, 1, sizeof bytes, from)) > 0)
        if (fwrite(bytes, 1, count, to) != count)
            return false;
    return !ferror(from);
}

static sonject_status add_categories(struct coco_file *coco)
{
    size_t i;
    const json_t *name;
    sonject_status status = SONJECT_OK;
    json_array_foreach(json_object_get(coco->set->head, "classes"), i, name)
    {
        THEN(status, add_entry(coco->set, coco->images,
                               coco_category(i + 1, json_string_value(name)), i == 0));
    }
    return status;
}

static sonject_status write_split(struct coco_file *coco, const char *path)
{
    struct report *report = coco->set->report;
    fprintf(coco->images,
            "{\"info\": {\"description\": \"targets injected by sonject\", \"version\": \"%s\"},\n"
            "\"licenses\": [],\n\"images\": [",
            sonject_version());
    sonject_status status = add_images(coco);
    fputs("],\n\"annotations\": [", coco->images);
    if (status == SONJECT_OK && !copy_all(coco->annotations, coco->images))
        status = file_failure(report, path, "write", errno);
    fputs("],\n\"categories\": [", coco->images);
    THEN(status, add_categories(coco));
    fputs("]}\n", coco->images);
    if (status == SONJECT_OK && (fflush(coco->images) != 0 || ferror(coco->images)))
        status = file_failure(report, path, "write", errno);
    return status;
}

static sonject_status write_coco_file(const struct data_set *set, size_t split, const char *path)
{
    char *part = file_part_name(path);
    char *waiting = file_part_name(path);
    struct coco_file coco = {set, split, NULL, NULL, 0};
    sonject_status status = SONJECT_OK;
    if (!part || !waiting) {
        status = report_out_of_memory(set->report, "a file name");
    } else {
        coco.images = fopen(part, "wb");
        coco.annotations = fopen(waiting, "w+b");
        if (!coco.images || !coco.annotations)
            status = file_failure(set->report, path, "write", errno);
    }
    THEN(status, write_split(&coco, path));
    if (coco.annotations)
        fclose(coco.annotations);
    if (coco.images && fclose(coco.images) != 0 && status == SONJECT_OK)
        status = file_failure(set->report, path, "write", errno);
    if (waiting)
        file_discard(waiting);
    if (status == SONJECT_OK)
        status = file_publish(set->report, part, path);
    else if (part)
        file_discard(part);
    free(part);
    free(waiting);
    return status;
}

sonject_status write_data_set_coco(const struct data_set *set)
{
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < set->split_count; i++) {
        char *path = campaign_file(set->folder, set->split_names[i], "coco.json", NULL);
        CHECK_MEMORY(set->report, path, "a file name");
        status = write_coco_file(set, i, path);
        free(path);
    }
    return status;
}
