/* The files of a data set's images: where they lie, whether they are as they were written, and
 * their records and truth, which are input to whoever puts the data set's documents together. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "base/text.h"
#include "dataset/data_set.h"

const struct output_kind output_kinds[OUTPUT_KINDS] = {
    [OUTPUT_IMAGE] = {"images", NULL},
    [OUTPUT_TRUTH] = {"truth", ".json"},
    [OUTPUT_HIGHLIGHT] = {"highlight", ".png"},
    [OUTPUT_SHADOW] = {"shadow", ".png"},
    [OUTPUT_MASKS] = {"masks", ".png"},
    [OUTPUT_ENERGY] = {"energy", ".tif"},
    [OUTPUT_FIELD] = {"field", ".tif"},
    [OUTPUT_YOLO] = {"labels", ".txt"},
    [OUTPUT_VOC] = {"voc", ".xml"},
    [OUTPUT_RECORD] = {"records", ".json"},
};

sonject_status image_files_init(struct image_files *files, struct report *report,
                                const char *folder, const char *split, uint64_t id,
                                uint32_t outputs, const char *extension)
{
    files->folder = path_join(folder, split);
    files->id = id;
    files->outputs = outputs;
    files->extension = extension;
    return files->folder ? SONJECT_OK : report_out_of_memory(report, "a file name");
}

const char *image_file_name(const struct image_files *files, enum output output,
                            char name[IMAGE_NAME_CAPACITY])
{
    const struct output_kind *kind = &output_kinds[output];
    snprintf(name, IMAGE_NAME_CAPACITY, "%s/%08" PRIu64 "%s", kind->folder, files->id,
             kind->extension ? kind->extension : files->extension);
    return name;
}

sonject_status image_files_list(const struct image_files *files, struct report *report,
                                json_t **list)
{
    char name[IMAGE_NAME_CAPACITY];
    sonject_status status = SONJECT_OK;
    *list = json_array();
    for (int i = 0; status == SONJECT_OK && i < OUTPUT_RECORD; i++)
        if (files->outputs & OUTPUT_BIT(i))
            status = file_list_add(list, report, files->folder,
                                   image_file_name(files, (enum output)i, name), false);
    if (status != SONJECT_OK) {
        json_decref(*list);
        *list = NULL;
    }
    return status;
}

/* Whether the list of a record names the image's files and no others. */
static bool lists_files(const struct image_files *files, const json_t *list)
{
    char name[IMAGE_NAME_CAPACITY];
    size_t count = 0;
    for (int i = 0; i < OUTPUT_RECORD; i++)
        if (files->outputs & OUTPUT_BIT(i) &&
            strcmp(member_text(json_array_get(list, count++), "name"),
                   image_file_name(files, (enum output)i, name)) != 0)
            return false;
    return json_array_size(list) == count;
}

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

/* Whether a box lies in the image and is not empty. */
static bool is_inside(const struct data_set *set, json_int_t row, json_int_t column,
                      json_int_t rows, json_int_t columns)
{
    return row >= 0 && column >= 0 && rows >= 1 && columns >= 1 && rows <= set->rows &&
           columns <= set->columns && row <= set->rows - rows && column <= set->columns - columns;
}

/* A list of so many whole numbers. */
static bool take_wholes(const json_t *list, size_t count, json_int_t *wholes)
{
    for (size_t i = 0; i < count; i++) {
        if (!json_is_integer(json_array_get(list, i)))
            return false;
        wholes[i] = json_integer_value(json_array_get(list, i));
    }
    return json_array_size(list) == count;
}

/* Whether runs, outside and inside by turns, fill the image and have so many pixels inside. */
static bool is_segmentation(const struct data_set *set, const json_t *segmentation, json_int_t area)
{
    const json_t *counts = json_object_get(segmentation, "counts");
    const json_int_t all = set->rows * set->columns;
    json_int_t sums[2] = {0, 0};
    json_int_t size[2];
    for (size_t i = 0; i < json_array_size(counts); i++) {
        const json_t *count = json_array_get(counts, i);
        const json_int_t run = json_is_integer(count) ? json_integer_value(count) : -1;
        if (run < 0 || run > all - sums[0] - sums[1])
            return false;
        sums[i % 2] += run;
    }
    return json_object_size(segmentation) == 2 && json_is_array(counts) &&
           take_wholes(json_object_get(segmentation, "size"), 2, size) && size[0] == set->rows &&
           size[1] == set->columns && sums[0] + sums[1] == all && sums[1] == area;
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

/* Null, or one of the campaign's classes. */
static bool is_target(const struct data_set *set, const json_t *target)
{
    size_t i;
    const json_t *known;
    json_array_foreach(json_object_get(set->head, "classes"), i, known)
    {
        if (json_equal(known, target))
            return true;
    }
    return json_is_null(target);
}

/* NULL, or what of a record is not as it should be. files: told the extension of the pixels. */
static const char *find_fault(const struct data_set *set, size_t split, struct image_files *files,
                              const json_t *record)
{
    char name[IMAGE_NAME_CAPACITY];
    const char *image = member_text(record, "image");
    const json_int_t id = (json_int_t)files->id;
    if (strstr(image, ".tif"))
        files->extension = ".tif";
    if (strcmp(member_text(record, "campaign_hash"), member_text(set->head, "hash")) != 0)
        return "campaign_hash: is not of this campaign";
    if (member_within(record, "id", id, id) < 0)
        return "id: is another image's";
    if (strcmp(member_text(record, "split"), set->split_names[split]) != 0)
        return "split: is not the folder's";
    if (strcmp(image, image_file_name(files, OUTPUT_IMAGE, name)) != 0)
        return "image: is not the name of this image's file";
    if (!is_target(set, json_object_get(record, "target")))
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

/* Of the truth: where documents look. */
static bool is_object(const struct data_set *set, const json_t *object)
{
    const json_t *box = json_object_get(object, "box");
    return has_plain(object, "class") &&
           (json_is_null(box) || is_inside(set, member_within(box, "row", 0, set->rows),
                                           member_within(box, "column", 0, set->columns),
                                           member_within(box, "rows", 1, set->rows),
                                           member_within(box, "columns", 1, set->columns)));
}

/* Reads the record, or the truth where files->extension is known by it. */
static sonject_status read_checked(const struct data_set *set, size_t split,
                                   struct image_files *files, enum output output, json_t **document)
{
    char name[IMAGE_NAME_CAPACITY];
    const char *fault = NULL;
    *document = NULL;
    char *path = path_join(files->folder, image_file_name(files, output, name));
    CHECK_MEMORY(set->report, path, "a file name");
    sonject_status status = json_document_read(set->report, path, document);
    if (status == SONJECT_OK && output == OUTPUT_RECORD)
        fault = find_fault(set, split, files, *document);
    else if (status == SONJECT_OK &&
             !all_are(set, json_object_get(*document, "objects"), is_object))
        fault = "objects: has one without a class, or whose box is not within the image";
    if (fault)
        status = report_failure(set->report, SONJECT_ERROR_INPUT,
                                "%s: %s; remove it and run the campaign again", path, fault);
    if (status != SONJECT_OK) {
        json_decref(*document);
        *document = NULL;
    }
    free(path);
    return status;
}

sonject_status data_set_image(const struct data_set *set, size_t split, uint64_t id,
                              json_t **record, json_t **truth, char **image)
{
    struct image_files files;
    char name[IMAGE_NAME_CAPACITY];
    *record = NULL;
    if (truth)
        *truth = NULL;
    CHECK(image_files_init(&files, set->report, set->folder, set->split_names[split], id,
                           set->outputs, ".png"));
    sonject_status status = read_checked(set, split, &files, OUTPUT_RECORD, record);
    if (status == SONJECT_OK && truth)
        status = read_checked(set, split, &files, OUTPUT_TRUTH, truth);
    if (status == SONJECT_OK && image) {
        *image = path_join(files.folder, image_file_name(&files, OUTPUT_IMAGE, name));
        if (!*image)
            status = report_out_of_memory(set->report, "a file name");
    }
    free(files.folder);
    if (status != SONJECT_OK) {
        json_decref(*record);
        json_decref(truth ? *truth : NULL);
        *record = NULL;
    }
    return status;
}

sonject_status data_set_has_image(const struct data_set *set, size_t split, uint64_t id,
                                  char **changed, bool *has)
{
    struct image_files files;
    char record_name[IMAGE_NAME_CAPACITY];
    json_t *record = NULL;
    const char *name = NULL; /* of the first file that is not as it was written */
    *has = false;
    CHECK(image_files_init(&files, set->report, set->folder, set->split_names[split], id,
                           set->outputs, ".png"));
    char *path = path_join(files.folder, image_file_name(&files, OUTPUT_RECORD, record_name));
    sonject_status status = path ? SONJECT_OK : report_out_of_memory(set->report, "a file name");
    if (path && file_exists(path)) {
        status = read_checked(set, split, &files, OUTPUT_RECORD, &record);
        const json_t *list = json_object_get(record, "files");
        if (status == SONJECT_ERROR_INPUT) {
            set->report->message[0] = '\0';
            status = SONJECT_OK;
        }
        if (!lists_files(&files, list))
            name = record_name; /* damaged, too */
        else
            THEN(status, file_list_check(list, set->report, files.folder, true, &name));
        *has = status == SONJECT_OK && !name;
    }
    if (name && changed && !*changed)
        *changed = path_join(files.folder, name);
    json_decref(record);
    free(path);
    free(files.folder);
    return status;
}
