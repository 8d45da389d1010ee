#include "api/campaign_documents.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/growing_text.h"
#include "base/json_document.h"

const char *member_text(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "";
}

double member_number(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : NAN;
}

bool data_set_is_finished(const struct data_set *set)
{
    char *path = path_join(set->folder, "dataset.json");
    const bool is_finished = path && file_exists(path);
    free(path);
    return is_finished;
}

sonject_status data_set_image(const struct data_set *set, size_t split, uint64_t id,
                              json_t **record, json_t **truth)
{
    struct image_files files;
    *record = NULL;
    if (truth)
        *truth = NULL;
    sonject_status status = image_files_init(&files, set->report, set->folder,
                                             set->split_names[split], id, PIXEL_UINT8, false, 0);
    if (status == SONJECT_OK)
        status = campaign_read_json(set->report, files.record, record);
    if (status == SONJECT_OK && truth)
        status = campaign_read_json(set->report, files.truth, truth);
    if (status == SONJECT_OK &&
        (strcmp(member_text(*record, "campaign_hash"), member_text(set->head, "hash")) != 0 ||
         (truth && !json_is_array(json_object_get(*truth, "objects")))))
        status = report_failure(set->report, SONJECT_ERROR_INPUT,
                                "%s: is not of this campaign; remove it and run the campaign again",
                                files.record);
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

/* Whether an image has all its files, of either extension. */
static sonject_status has_image(const struct data_set *set, size_t split, uint64_t id, bool *has)
{
    *has = false;
    for (int type = 0; type < 2 && !*has; type++) {
        struct image_files files;
        const sonject_status status =
            image_files_init(&files, set->report, set->folder, set->split_names[split], id,
                             type == 0 ? PIXEL_UINT8 : PIXEL_FLOAT32, false, set->outputs);
        *has = status == SONJECT_OK && image_files_exist(&files);
        image_files_clear(&files);
        if (status != SONJECT_OK)
            return status;
    }
    return SONJECT_OK;
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
    sonject_status status = SONJECT_OK;
    memset(&missing, 0, sizeof missing);
    for (size_t i = 0; status == SONJECT_OK && i < set->split_count; i++)
        for (uint64_t k = 0; status == SONJECT_OK && k < set->split_images[i]; k++) {
            bool has = false;
            status = has_image(set, i, set->split_first[i] + k, &has);
            if (status == SONJECT_OK && !has)
                add_missing(&missing, set->split_first[i] + k);
        }
    if (missing.count > 0)
        tell_range(&missing);
    char *ids = growing_text_end(&missing.text);
    if (status == SONJECT_OK && missing.count > 0)
        status = report_failure(set->report, SONJECT_ERROR_INPUT,
                                "%s: %llu of %llu images are missing: %s; run the campaign or its "
                                "shards again",
                                set->folder, (unsigned long long)missing.count,
                                (unsigned long long)set->images, ids ? ids : "");
    free(ids);
    return status;
}

/* What the whole is: the last document, so a folder with dataset.json is complete. */
static sonject_status write_data_set(const struct data_set *set)
{
    char *path = path_join(set->folder, "dataset.json");
    if (!path)
        return report_out_of_memory(set->report, "a file name");
    json_t *document = json_object();
    static const char *const kept[] = {"sonject", "hash",   "device",  "images",  "rows",
                                       "columns", "splits", "classes", "outputs", "swaths"};
    for (size_t i = 0; i < sizeof kept / sizeof *kept; i++)
        json_add(&document, kept[i], json_incref(json_object_get(set->head, kept[i])));
    const sonject_status status = campaign_write_json(set->report, document, path);
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
    json_array_foreach(json_object_get(set->head, "classes"), i, name)
    {
        growing_text_add(&text, "%s\n", json_string_value(name) ? json_string_value(name) : "");
    }
    char *names = growing_text_end(&text);
    const sonject_status status = path && names
                                      ? file_write_whole(set->report, path, names, strlen(names))
                                      : report_out_of_memory(set->report, "classes.txt");
    free(path);
    free(names);
    return status;
}

sonject_status data_set_finish(struct data_set *set)
{
    sonject_status status = check_complete(set);
    if (status == SONJECT_OK)
        status = write_data_set_coco(set);
    if (status == SONJECT_OK)
        status = write_classes(set);
    if (status == SONJECT_OK)
        status = write_contact_sheet(set);
    if (status == SONJECT_OK)
        status = write_report_page(set);
    if (status == SONJECT_OK)
        status = write_data_set(set);
    if (status != SONJECT_OK)
        return status;
    for (size_t i = 0; i < set->split_count; i++)
        split_folders_tidy(set->folder, set->split_names[i], set->outputs);
    folder_tidy(set->folder);
    return SONJECT_OK;
}
