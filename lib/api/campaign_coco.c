/* COCO documents of the splits, put together image by image. */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "api/campaign_documents.h"
#include "base/file.h"
#include "base/json_document.h"
#include "dataset/labels.h"

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
