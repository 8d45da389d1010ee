#include "api/campaign_documents.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/file.h"
#include "base/growing_text.h"
#include "base/json_document.h"

#define FORMAT_VERSION 1

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

static void add_class(json_t **classes, const char *name)
{
    size_t i;
    const json_t *known;
    json_array_foreach(*classes, i, known)
    {
        if (strcmp(json_string_value(known), name) == 0)
            return;
    }
    json_append(classes, json_string(name));
}

static json_t *classes_of(const struct campaign *campaign)
{
    json_t *classes = json_array();
    for (size_t i = 0; i < campaign->target_count; i++)
        add_class(&classes, campaign->targets[i].class_name);
    for (size_t i = 0; i < campaign->clutter_count; i++)
        add_class(&classes, campaign->clutter[i].class_name);
    return classes;
}

static json_t *splits_of(const struct campaign *campaign)
{
    json_t *splits = json_array();
    for (size_t i = 0; i < campaign->split_count; i++) {
        const struct split *split = &campaign->splits[i];
        json_append(&splits,
                    json_pack("{s:s, s:I, s:I}", "name", split->name, "first_image",
                              (json_int_t)split->first_image, "images", (json_int_t)split->images));
    }
    return splits;
}

static json_t *swaths_of(const struct sonject_campaign *campaign)
{
    json_t *swaths = json_array();
    for (size_t i = 0; i < campaign->campaign.swath_count; i++) {
        const struct swath_plan *swath = &campaign->campaign.swaths[i];
        json_append(&swaths, json_pack("{s:s, s:s, s:s}", "path", swath->written, "hash",
                                       campaign->swath_hashes[i], "split",
                                       campaign->campaign.splits[swath->split_number].name));
    }
    return swaths;
}

static json_t *outputs_of(uint32_t outputs)
{
    json_t *names = json_array();
    for (size_t i = 0; i < OUTPUT_KINDS; i++)
        if (outputs & output_files[i].output)
            json_append(&names, json_string(output_files[i].folder));
    return names;
}

static json_t *head_of(const struct sonject_campaign *campaign, const char *code)
{
    const struct campaign *plan = &campaign->campaign;
    return json_pack("{s:i, s:s, s:s, s:s, s:I, s:I, s:I, s:o, s:o, s:o, s:o}", "sonject_campaign",
                     FORMAT_VERSION, "sonject", sonject_version(), "code_hash", code, "hash",
                     campaign->hash, "images", (json_int_t)plan->images, "rows",
                     (json_int_t)plan->chip_rows, "columns", (json_int_t)plan->chip_columns,
                     "splits", splits_of(plan), "classes", classes_of(plan), "outputs",
                     outputs_of(plan->outputs), "swaths", swaths_of(campaign));
}

sonject_status data_set_begin(struct sonject_campaign *campaign, const char *folder)
{
    struct report *report = campaign->report;
    json_t *head = NULL;
    char code[HASH_TEXT_CAPACITY];
    char *path = path_join(folder, "campaign.json");
    if (!path)
        return report_out_of_memory(report, "a file name");
    sonject_status status = code_hash(report, code);
    if (status == SONJECT_OK && !file_exists(path))
        status = campaign_write_json(report, head_of(campaign, code), path);
    else if (status == SONJECT_OK)
        status = campaign_read_json(report, path, &head);
    if (status == SONJECT_OK && head && strcmp(member_text(head, "code_hash"), code) != 0)
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s: holds images that another version of sonject made (%s); "
                                "choose another folder",
                                folder, member_text(head, "sonject"));
    else if (status == SONJECT_OK && head && strcmp(member_text(head, "hash"), campaign->hash) != 0)
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s: holds the images of another campaign, or of this one before "
                                "its file, scene, targets or swaths changed; choose another folder",
                                folder);
    json_decref(head);
    free(path);
    return status;
}

/* True if what documents need of the head is as it should be. */
static bool take_head(struct data_set *set)
{
    const json_t *splits = json_object_get(set->head, "splits");
    const json_t *outputs = json_object_get(set->head, "outputs");
    uint64_t next = 0;
    set->split_count = json_array_size(splits);
    if (json_integer_value(json_object_get(set->head, "sonject_campaign")) != FORMAT_VERSION ||
        set->split_count == 0 || set->split_count > CAMPAIGN_SPLITS_MAX ||
        !json_is_array(outputs) || !json_is_array(json_object_get(set->head, "classes")))
        return false;
    for (size_t i = 0; i < set->split_count; i++) {
        const json_t *split = json_array_get(splits, i);
        const json_int_t images = json_integer_value(json_object_get(split, "images"));
        const char *name = member_text(split, "name");
        if (images < 0 || images > CAMPAIGN_IMAGES_MAX || !*name || strpbrk(name, "/."))
            return false;
        set->split_names[i] = name;
        set->split_first[i] = next;
        set->split_images[i] = (uint64_t)images;
        next += (uint64_t)images;
    }
    set->images = next;
    for (size_t i = 0; i < OUTPUT_KINDS; i++)
        for (size_t j = 0; j < json_array_size(outputs); j++) {
            const char *name = json_string_value(json_array_get(outputs, j));
            if (name && strcmp(name, output_files[i].folder) == 0)
                set->outputs |= output_files[i].output;
        }
    return true;
}

sonject_status data_set_open(struct data_set *set, struct report *report, const char *folder)
{
    char *path = path_join(folder, "campaign.json");
    set->report = report;
    set->folder = folder;
    if (!path)
        return report_out_of_memory(report, "a file name");
    sonject_status status = SONJECT_OK;
    if (!file_exists(path))
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s: holds no campaign: there is no campaign.json", folder);
    if (status == SONJECT_OK)
        status = campaign_read_json(report, path, &set->head);
    if (status == SONJECT_OK && !take_head(set))
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s: damaged; remove it and run the campaign again", path);
    free(path);
    return status;
}

void data_set_clear(struct data_set *set)
{
    json_decref(set->head);
    memset(set, 0, sizeof *set);
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
    *truth = NULL;
    sonject_status status = image_files_init(&files, set->report, set->folder,
                                             set->split_names[split], id, PIXEL_UINT8, false, 0);
    if (status == SONJECT_OK)
        status = campaign_read_json(set->report, files.record, record);
    if (status == SONJECT_OK)
        status = campaign_read_json(set->report, files.truth, truth);
    if (status == SONJECT_OK &&
        (strcmp(member_text(*record, "campaign_hash"), member_text(set->head, "hash")) != 0 ||
         !json_is_array(json_object_get(*truth, "objects"))))
        status = report_failure(set->report, SONJECT_ERROR_INPUT,
                                "%s: is not of this campaign; remove it and run the campaign again",
                                files.record);
    image_files_clear(&files);
    if (status != SONJECT_OK) {
        json_decref(*record);
        json_decref(*truth);
        *record = NULL;
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
    static const char *const kept[] = {"sonject", "hash",    "images",  "rows",  "columns",
                                       "splits",  "classes", "outputs", "swaths"};
    for (size_t i = 0; i < sizeof kept / sizeof *kept; i++)
        json_object_set(document, kept[i], json_object_get(set->head, kept[i]));
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
