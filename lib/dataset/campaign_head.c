/* campaign.json: what a data set is, written by whoever begins it and checked by all others. */
#include <string.h>

#include <sonject/version.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/text.h"
#include "dataset/campaign_documents.h"
#include "dataset/documents.h"
#include "dataset/earlier_result.h"

#define FORMAT_VERSION 2
#define HEAD_FILE      "campaign.json"

static json_t *classes_of(const struct class_names *classes)
{
    json_t *names = json_array();
    for (uint32_t i = 0; i < classes->count; i++)
        json_append(&names, json_string(classes->names[i]));
    return names;
}

static json_t *splits_of(const struct campaign *campaign)
{
    json_t *splits = json_array();
    for (size_t i = 0; i < campaign->split_count; i++) {
        const struct split *split = &campaign->splits[i];
        json_append(&splits, JSON_OBJECT({"name", json_string(split->name)},
                                         {"first_image", json_count(split->first_image)},
                                         {"images", json_count(split->images)}));
    }
    return splits;
}

static json_t *swaths_of(const struct sonject_campaign *campaign)
{
    json_t *swaths = json_array();
    for (size_t i = 0; i < campaign->campaign.swath_count; i++) {
        const struct swath_plan *swath = &campaign->campaign.swaths[i];
        const char *split = campaign->campaign.splits[swath->split_number].name;
        json_append(&swaths, JSON_OBJECT({"path", json_string(swath->written)},
                                         {"hash", json_string(campaign->swath_hashes[i])},
                                         {"split", json_string(split)}));
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

static json_t *head_of(const struct sonject_campaign *campaign, const struct device *device,
                       json_t *inputs)
{
    const struct campaign *plan = &campaign->campaign;
    return JSON_OBJECT({"sonject_campaign", json_integer(FORMAT_VERSION)},
                       {"sonject", json_string(sonject_version())},
                       {"hash", json_string(campaign->hash)}, {"inputs", json_incref(inputs)},
                       {"device", device ? device_document(device) : json_null()},
                       {"images", json_count(plan->images)}, {"rows", json_count(plan->chip_rows)},
                       {"columns", json_count(plan->chip_columns)}, {"splits", splits_of(plan)},
                       {"classes", classes_of(&campaign->classes)},
                       {"outputs", outputs_of(plan->outputs)}, {"swaths", swaths_of(campaign)});
}

/* Whose images the folder holds; those of another campaign are removed where they may be. */
static sonject_status check_head(struct sonject_campaign *campaign, const json_t *inputs,
                                 const char *folder, bool overwrites, bool *is_same)
{
    struct data_set set;
    memset(&set, 0, sizeof set);
    sonject_status status = data_set_open(&set, campaign->report, folder);
    THEN(status, inputs_check(campaign->report, folder, json_object_get(set.head, "inputs"), inputs,
                              NULL, overwrites, is_same));
    if (status == SONJECT_OK && !*is_same)
        data_set_remove(&set);
    data_set_clear(&set);
    return status;
}

sonject_status data_set_begin(struct sonject_campaign *campaign, const struct device *device,
                              const char *folder, bool overwrites)
{
    struct report *report = campaign->report;
    bool is_same = false;
    json_t *inputs = json_copy(campaign->inputs);
    char *path = path_join(folder, HEAD_FILE);
    if (device)
        json_add(&inputs, "device", device_document(device));
    sonject_status status = path && inputs ? SONJECT_OK : report_out_of_memory(report, "inputs");
    if (status == SONJECT_OK && file_exists(path))
        status = check_head(campaign, inputs, folder, overwrites, &is_same);
    if (status == SONJECT_OK && !is_same)
        status = json_document_write(report, head_of(campaign, device, inputs), 9, path);
    json_decref(inputs);
    free(path);
    return status;
}

/* Names and numbers of images, one split after the other. */
static bool take_splits(struct data_set *set, const json_t *splits)
{
    set->split_count = json_array_size(splits);
    if (set->split_count == 0 || set->split_count > CAMPAIGN_SPLITS_MAX)
        return false;
    for (size_t i = 0; i < set->split_count; i++) {
        const json_t *split = json_array_get(splits, i);
        const json_int_t images = json_integer_value(json_object_get(split, "images"));
        const char *name = member_text(split, "name");
        if (images < 0 || images > CAMPAIGN_IMAGES_MAX || !is_split_name(name))
            return false;
        set->split_names[i] = name;
        set->split_first[i] = set->images;
        set->split_images[i] = (uint64_t)images;
        set->images += (uint64_t)images;
    }
    return set->images > 0;
}

static bool is_class_name(const struct data_set *set, const json_t *name)
{
    (void)set;
    return json_is_string(name) && *json_string_value(name) &&
           text_is_printable(json_string_value(name));
}

static bool is_swath(const struct data_set *set, const json_t *swath)
{
    (void)set;
    return has_plain(swath, "path") && has_plain(swath, "hash") &&
           is_split_name(member_text(swath, "split"));
}

static bool is_side(const json_t *pixels)
{
    return json_is_integer(pixels) && json_integer_value(pixels) >= 1 &&
           json_integer_value(pixels) <= CAMPAIGN_CHIP_MAX;
}

static void take_outputs(struct data_set *set, const json_t *outputs)
{
    size_t i;
    const json_t *name;
    json_array_foreach(outputs, i, name)
    {
        for (size_t kind = 0; json_is_string(name) && kind < OUTPUT_KINDS; kind++)
            if (strcmp(json_string_value(name), output_files[kind].folder) == 0)
                set->outputs |= output_files[kind].output;
    }
}

/* True if what documents need of the head is as it should be. */
static bool read_head(struct data_set *set)
{
    const json_t *outputs = json_object_get(set->head, "outputs");
    const json_t *device = json_object_get(set->head, "device");
    const json_t *classes = json_object_get(set->head, "classes");
    take_outputs(set, outputs);
    set->rows = json_integer_value(json_object_get(set->head, "rows"));
    set->columns = json_integer_value(json_object_get(set->head, "columns"));
    return json_integer_value(json_object_get(set->head, "sonject_campaign")) == FORMAT_VERSION &&
           has_plain(set->head, "sonject") && has_plain(set->head, "hash") &&
           is_side(json_object_get(set->head, "rows")) &&
           is_side(json_object_get(set->head, "columns")) && json_is_array(outputs) &&
           all_are(set, json_object_get(set->head, "swaths"), is_swath) &&
           (json_is_null(device) || json_is_object(device)) &&
           all_are(set, classes, is_class_name) && json_array_size(classes) <= CLASSES_MAX &&
           take_splits(set, json_object_get(set->head, "splits")) &&
           json_integer_value(json_object_get(set->head, "images")) == (json_int_t)set->images;
}

sonject_status data_set_open(struct data_set *set, struct report *report, const char *folder)
{
    char *path = path_join(folder, HEAD_FILE);
    set->report = report;
    set->folder = folder;
    CHECK_MEMORY(report, path, "a file name");
    sonject_status status = SONJECT_OK;
    if (!file_exists(path))
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s: holds no campaign: there is no campaign.json", folder);
    THEN(status, json_document_read(report, path, &set->head));
    if (status == SONJECT_OK && !read_head(set))
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
