/* Records and truth of images, which are input to whoever puts a data set's documents together. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "base/text.h"
#include "dataset/campaign_documents.h"

const char *member_text(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "";
}

/* A member that is a whole number from smallest to largest; -1 where it is not. */
static json_int_t member_within(const json_t *object, const char *key, json_int_t smallest,
                                json_int_t largest)
{
    const json_t *value = json_object_get(object, key);
    const json_int_t whole = json_is_integer(value) ? json_integer_value(value) : smallest - 1;
    return whole >= smallest && whole <= largest ? whole : -1;
}

bool has_plain(const json_t *object, const char *key)
{
    const char *text = member_text(object, key);
    return *text && text_is_printable(text);
}

bool all_are(const struct data_set *set, const json_t *list,
             bool (*is_one)(const struct data_set *set, const json_t *element))
{
    for (size_t i = 0; i < json_array_size(list); i++)
        if (!is_one(set, json_array_get(list, i)))
            return false;
    return json_is_array(list);
}

static bool is_printable(const struct data_set *set, const json_t *text)
{
    (void)set;
    return json_is_string(text) && text_is_printable(json_string_value(text));
}

static bool is_class(const struct data_set *set, const char *name)
{
    size_t i;
    const json_t *known;
    json_array_foreach(json_object_get(set->head, "classes"), i, known)
    {
        if (strcmp(json_string_value(known), name) == 0)
            return true;
    }
    return false;
}

/* Whether a box lies in the image and is not empty. */
static bool is_inside(const struct data_set *set, json_int_t row, json_int_t column,
                      json_int_t rows, json_int_t columns)
{
    return row >= 0 && column >= 0 && rows >= 1 && columns >= 1 && rows <= set->rows &&
           columns <= set->columns && row <= set->rows - rows && column <= set->columns - columns;
}

/* Whether runs, outside and inside by turns, fill the image and have so many pixels inside. */
static bool are_runs(const struct data_set *set, const json_t *counts, json_int_t area)
{
    size_t i;
    const json_t *count;
    json_int_t sums[2] = {0, 0};
    const json_int_t all = set->rows * set->columns;
    json_array_foreach(counts, i, count)
    {
        const json_int_t run = json_is_integer(count) ? json_integer_value(count) : -1;
        if (run < 0 || run > all - sums[0] - sums[1])
            return false;
        sums[i % 2] += run;
    }
    return json_is_array(counts) && sums[0] + sums[1] == all && sums[1] == area;
}

/* A list of so many whole numbers. */
static bool take_wholes(const json_t *list, size_t count, json_int_t *wholes)
{
    for (size_t i = 0; i < count; i++) {
        const json_t *whole = json_array_get(list, i);
        if (!json_is_integer(whole))
            return false;
        wholes[i] = json_integer_value(whole);
    }
    return json_array_size(list) == count;
}

static bool is_segmentation(const struct data_set *set, const json_t *segmentation, json_int_t area)
{
    json_int_t size[2];
    return json_object_size(segmentation) == 2 &&
           take_wholes(json_object_get(segmentation, "size"), 2, size) && size[0] == set->rows &&
           size[1] == set->columns && are_runs(set, json_object_get(segmentation, "counts"), area);
}

/* Of coco_annotations; annotations are copied as they are, so no others may be. */
#define ANNOTATION_MEMBERS 10

static bool is_annotation(const struct data_set *set, const json_t *annotation)
{
    json_int_t box[4]; /* column, row, columns, rows */
    const json_int_t classes = (json_int_t)json_array_size(json_object_get(set->head, "classes"));
    return json_object_size(annotation) == ANNOTATION_MEMBERS &&
           member_within(annotation, "id", 1, UINT32_MAX) > 0 &&
           member_within(annotation, "image_id", 1, UINT32_MAX) > 0 &&
           member_within(annotation, "category_id", 1, classes) > 0 &&
           take_wholes(json_object_get(annotation, "bbox"), 4, box) &&
           is_inside(set, box[1], box[0], box[3], box[2]) &&
           member_within(annotation, "area", 1, box[2] * box[3]) > 0 &&
           is_segmentation(set, json_object_get(annotation, "segmentation"),
                           json_integer_value(json_object_get(annotation, "area"))) &&
           member_within(annotation, "iscrowd", 0, 0) == 0 &&
           member_within(annotation, "object_id", 1, UINT32_MAX) > 0 &&
           json_is_boolean(json_object_get(annotation, "truncated")) &&
           json_is_boolean(json_object_get(annotation, "occluded"));
}

static bool is_place(const struct data_set *set, const json_t *swath)
{
    const json_int_t largest = INT64_MAX >> 1;
    return has_plain(swath, "path") && has_plain(swath, "hash") &&
           member_within(swath, "row", 0, largest) >= 0 &&
           member_within(swath, "column", 0, largest) >= 0 &&
           member_within(swath, "rows", set->rows, set->rows) >= 0 &&
           member_within(swath, "columns", set->columns, set->columns) >= 0;
}

static bool is_seed(const json_t *seed)
{
    uint64_t count;
    return json_is_integer(seed)
               ? json_integer_value(seed) >= 0
               : json_is_string(seed) && text_to_count(json_string_value(seed), &count);
}

/* "images/00000007" and one of the extensions of images. */
static bool is_image_name(const char *name, uint64_t id)
{
    char stem[32];
    snprintf(stem, sizeof stem, "images/%08" PRIu64, id);
    if (strncmp(name, stem, strlen(stem)) != 0)
        return false;
    const char *extension = name + strlen(stem);
    return strcmp(extension, ".png") == 0 || strcmp(extension, ".tif") == 0;
}

/* NULL, or what of a record is not as it should be. */
static const char *find_fault(const struct data_set *set, size_t split, uint64_t id,
                              const json_t *record)
{
    const json_t *target = json_object_get(record, "target");
    if (strcmp(member_text(record, "campaign_hash"), member_text(set->head, "hash")) != 0)
        return "campaign_hash: is not of this campaign";
    if (member_within(record, "id", (json_int_t)id, (json_int_t)id) < 0)
        return "id: is another image's";
    if (strcmp(member_text(record, "split"), set->split_names[split]) != 0)
        return "split: is not the folder's";
    if (!is_image_name(member_text(record, "image"), id))
        return "image: is not the name of this image's file";
    if (!json_is_null(target) &&
        !(json_is_string(target) && is_class(set, json_string_value(target))))
        return "target: is no class of the campaign";
    if (!is_place(set, json_object_get(record, "swath")))
        return "swath: is no place of an image in a swath";
    if (!is_seed(json_object_get(record, "seed")))
        return "seed: is none";
    if (!all_are(set, json_object_get(record, "set"), is_printable))
        return "set: is no list of keys with values";
    if (!has_plain(record, "scene") || !has_plain(record, "scene_hash") ||
        !has_plain(record, "sonject"))
        return "scene, scene_hash or sonject: is no text";
    if (!all_are(set, json_object_get(record, "annotations"), is_annotation))
        return "annotations: has one that is damaged, of no class, or not within the image";
    return NULL;
}

static bool is_box(const struct data_set *set, const json_t *box)
{
    return json_is_null(box) || is_inside(set, member_within(box, "row", 0, set->rows),
                                          member_within(box, "column", 0, set->columns),
                                          member_within(box, "rows", 1, set->rows),
                                          member_within(box, "columns", 1, set->columns));
}

static bool is_object(const struct data_set *set, const json_t *object)
{
    return has_plain(object, "class") && is_box(set, json_object_get(object, "box"));
}

static sonject_status refuse_record(const struct data_set *set, const char *path, const char *what)
{
    return report_failure(set->report, SONJECT_ERROR_INPUT,
                          "%s: %s; remove it and run the campaign again", path, what);
}

/* The record, and the image's files, whose extension it tells. files: for image_files_clear. */
static sonject_status read_record(const struct data_set *set, size_t split, uint64_t id,
                                  struct image_files *files, json_t **record)
{
    *record = NULL;
    sonject_status status =
        image_files_init(files, set->report, set->folder, set->split_names[split], id, PIXEL_UINT8,
                         false, set->outputs);
    THEN(status, json_document_read(set->report, files->record, record));
    const char *fault = status == SONJECT_OK ? find_fault(set, split, id, *record) : NULL;
    if (fault)
        return refuse_record(set, files->record, fault);
    if (status != SONJECT_OK || strstr(member_text(*record, "image"), ".png"))
        return status;
    image_files_clear(files);
    return image_files_init(files, set->report, set->folder, set->split_names[split], id,
                            PIXEL_FLOAT32, false, set->outputs);
}

sonject_status data_set_image(const struct data_set *set, size_t split, uint64_t id,
                              json_t **record, json_t **truth, char **image)
{
    struct image_files files;
    if (truth)
        *truth = NULL;
    sonject_status status = read_record(set, split, id, &files, record);
    if (status == SONJECT_OK && truth)
        status = json_document_read(set->report, files.truth, truth);
    if (status == SONJECT_OK && truth &&
        !all_are(set, json_object_get(*truth, "objects"), is_object))
        status = refuse_record(set, files.truth,
                               "objects: has one without a class, or whose box "
                               "is not within the image");
    if (status == SONJECT_OK && image) {
        *image = files.image;
        files.image = NULL;
    }
    image_files_clear(&files);
    if (status != SONJECT_OK) {
        json_decref(*record);
        *record = NULL;
    }
    if (status != SONJECT_OK && truth) {
        json_decref(*truth);
        *truth = NULL;
    }
    return status;
}

sonject_status data_set_has_image(const struct data_set *set, size_t split, uint64_t id,
                                  char **changed, bool *has)
{
    struct image_files files;
    json_t *record = NULL;
    const char *path = NULL;
    *has = false;
    sonject_status status = image_files_init(&files, set->report, set->folder,
                                             set->split_names[split], id, PIXEL_UINT8, false, 0);
    const bool is_begun = status == SONJECT_OK && file_exists(files.record);
    image_files_clear(&files);
    if (!is_begun)
        return status;
    status = read_record(set, split, id, &files, &record);
    if (status == SONJECT_OK)
        status = image_files_check(&files, set->report, json_object_get(record, "files"), &path);
    else if (status == SONJECT_ERROR_INPUT)
        path = files.record;
    *has = status == SONJECT_OK && !path;
    if (status == SONJECT_ERROR_INPUT) {
        set->report->message[0] = '\0';
        status = SONJECT_OK;
    }
    if (path && changed && !*changed)
        *changed = copy_text(path);
    json_decref(record);
    image_files_clear(&files);
    return status;
}
