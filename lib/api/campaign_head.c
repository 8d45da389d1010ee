/* campaign.json: what a data set is, written by whoever begins it and checked by all others. */
#include <string.h>

#include <sonject/version.h>

#include "api/campaign_documents.h"
#include "api/documents.h"
#include "api/scene_hash.h"
#include "base/file.h"
#include "base/json_document.h"

#define FORMAT_VERSION 1

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

static json_t *head_of(const struct sonject_campaign *campaign, const struct device *device,
                       const char *code)
{
    const struct campaign *plan = &campaign->campaign;
    return json_pack(
        "{s:i, s:s, s:s, s:s, s:o, s:I, s:I, s:I, s:o, s:o, s:o, s:o}", "sonject_campaign",
        FORMAT_VERSION, "sonject", sonject_version(), "code_hash", code, "hash", campaign->hash,
        "device", device ? device_document(device) : json_null(), "images",
        (json_int_t)plan->images, "rows", (json_int_t)plan->chip_rows, "columns",
        (json_int_t)plan->chip_columns, "splits", splits_of(plan), "classes", classes_of(plan),
        "outputs", outputs_of(plan->outputs), "swaths", swaths_of(campaign));
}

static bool has_same_text(const json_t *head, const json_t *own, const char *key)
{
    return strcmp(member_text(head, key), member_text(own, key)) == 0;
}

/* The head that the folder has against the one that it would get. */
static sonject_status check_head(struct report *report, const char *folder, const json_t *head,
                                 const json_t *own)
{
    if (!has_same_text(head, own, "code_hash"))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: holds images that another version of sonject made (%s); "
                              "choose another folder",
                              folder, member_text(head, "sonject"));
    if (!has_same_text(head, own, "hash"))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: holds the images of another campaign, or of this one before "
                              "its file, scene, targets or swaths changed; choose another folder",
                              folder);
    if (!json_equal(json_object_get(head, "device"), json_object_get(own, "device")))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: holds images of another device, on which code of shapes may "
                              "answer differently; choose that device or another folder",
                              folder);
    return SONJECT_OK;
}

sonject_status data_set_begin(struct sonject_campaign *campaign, const struct device *device,
                              const char *folder)
{
    struct report *report = campaign->report;
    json_t *head = NULL;
    json_t *own = NULL;
    char code[HASH_TEXT_CAPACITY];
    char *path = path_join(folder, "campaign.json");
    if (!path)
        return report_out_of_memory(report, "a file name");
    sonject_status status = code_hash(report, code);
    if (status == SONJECT_OK && !(own = head_of(campaign, device, code)))
        status = report_out_of_memory(report, path);
    if (status == SONJECT_OK && !file_exists(path))
        status = campaign_write_json(report, json_incref(own), path);
    else if (status == SONJECT_OK)
        status = campaign_read_json(report, path, &head);
    if (status == SONJECT_OK && head)
        status = check_head(report, folder, head, own);
    json_decref(own);
    json_decref(head);
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

static bool has_classes(const json_t *classes)
{
    size_t i;
    const json_t *name;
    json_array_foreach(classes, i, name)
    {
        if (!json_is_string(name))
            return false;
    }
    return json_is_array(classes) && json_array_size(classes) <= CLASSES_MAX;
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

/* What documents take over as it is. */
static bool has_facts(const json_t *head)
{
    return json_is_string(json_object_get(head, "sonject")) &&
           json_is_string(json_object_get(head, "hash")) &&
           json_is_integer(json_object_get(head, "images")) &&
           json_is_integer(json_object_get(head, "rows")) &&
           json_is_integer(json_object_get(head, "columns")) &&
           json_is_array(json_object_get(head, "swaths")) && json_object_get(head, "device");
}

/* True if what documents need of the head is as it should be. */
static bool take_head(struct data_set *set)
{
    const json_t *outputs = json_object_get(set->head, "outputs");
    take_outputs(set, outputs);
    return json_integer_value(json_object_get(set->head, "sonject_campaign")) == FORMAT_VERSION &&
           has_facts(set->head) && json_is_array(outputs) &&
           has_classes(json_object_get(set->head, "classes")) &&
           take_splits(set, json_object_get(set->head, "splits"));
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
