/* The documents of a whole data set. campaign.json says what the set is; the process that begins
 * the set writes it, and all others check it. COCO documents of splits are put together image by
 * image. dataset.json comes last, so that a folder that has it is complete. */
#include "dataset/data_set.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/json_document.h"
#include "base/text.h"
#include "dataset/run.h"

#define FORMAT_VERSION 4
#define HEAD_FILE      "campaign.json"
#define LAST_FILE      "dataset.json"

#define DOCUMENTS 5

/* Lists the documents of the whole besides campaign.json and dataset.json, and returns their
 * number. croissant.json comes behind the documents that it lists. */
static size_t name_documents(uint32_t outputs, const char *names[DOCUMENTS])
{
    size_t count = 0;
    names[count++] = "classes.txt";
    names[count++] = "contact_sheet.png";
    names[count++] = REPORT_PAGE;
    if (outputs & OUTPUT_BIT(OUTPUT_YOLO))
        names[count++] = "data.yaml";
    names[count++] = "croissant.json";
    return count;
}

/* Calls a function for each folder of a split. */
static sonject_status each_folder(struct report *report, const char *folder, const char *split,
                                  uint32_t outputs,
                                  sonject_status (*call)(struct report *report, const char *path))
{
    char path[PATH_CAPACITY];
    for (int i = 0; i < OUTPUT_KINDS; i++)
        if (outputs & OUTPUT_BIT(i)) {
            CHECK(path_in(report, path, folder, "%s/%s", split, output_kinds[i].folder));
            CHECK(call(report, path));
        }
    return SONJECT_OK;
}

/* Removes numbered files, such as images, chips and calibrations, and the folder if it is empty. */
static sonject_status remove_numbered(struct report *report, const char *path)
{
    struct folder_names list;
    char file[PATH_CAPACITY];
    if (folder_names_read(&list, report, path, "") != SONJECT_OK)
        return SONJECT_OK;
    for (size_t i = 0; i < list.count; i++) {
        const size_t digits = strspn(list.names[i], "0123456789");
        if (digits > 0 && list.names[i][digits] == '.' &&
            path_in(report, file, path, "%s", list.names[i]) == SONJECT_OK)
            file_discard(file);
    }
    folder_names_clear(&list);
    folder_discard(path);
    return SONJECT_OK;
}

static sonject_status tidy(struct report *report, const char *path)
{
    (void)report;
    folder_tidy(path);
    return SONJECT_OK;
}

static void discard(const char *folder, const char *name)
{
    struct report ignored = {.host = NULL};
    char path[PATH_CAPACITY];
    if (path_in(&ignored, path, folder, "%s", name) == SONJECT_OK)
        file_discard(path);
}

/* Folders beside the splits', whose files are numbered. */
static const char *const numbered[] = {CALIBRATIONS_FOLDER, CHIPS_FOLDER, SWATHS_FOLDER};

/* Removes the images and documents, campaign.json last. */
static void remove_all(const struct data_set *set)
{
    struct report ignored = {.host = NULL};
    char path[PATH_CAPACITY];
    const char *documents[DOCUMENTS];
    discard(set->folder, LAST_FILE);
    const size_t count = name_documents(UINT32_MAX, documents);
    for (size_t i = 0; i < count; i++)
        discard(set->folder, documents[i]);
    discard(set->folder, "times.json");
    for (size_t i = 0; i < COUNT(numbered); i++)
        if (path_in(&ignored, path, set->folder, "%s", numbered[i]) == SONJECT_OK)
            remove_numbered(&ignored, path);
    for (size_t i = 0; i < set->split_count; i++) {
        each_folder(&ignored, set->folder, set->split_names[i], UINT32_MAX, remove_numbered);
        if (path_in(&ignored, path, set->folder, "%s", set->split_names[i]) == SONJECT_OK) {
            discard(path, "coco.json");
            folder_discard(path);
        }
    }
    discard(set->folder, HEAD_FILE);
}

static json_t *side_of(uint32_t pixels)
{
    return pixels > 0 ? json_count(pixels) : json_string("all");
}

static json_t *head_of(const struct sonject_campaign *campaign)
{
    const struct campaign *plan = &campaign->campaign;
    json_t *splits = json_array();
    json_t *classes = json_array();
    json_t *outputs = json_array();
    json_t *swaths = json_array();
    for (size_t i = 0; i < plan->split_count; i++)
        json_append(&splits, JSON_OBJECT({"name", json_string(plan->splits[i].name)},
                                         {"first_image", json_count(plan->splits[i].first_image)},
                                         {"images", json_count(plan->splits[i].images)}));
    for (uint32_t i = 0; i < campaign->classes.count; i++)
        json_append(&classes, json_string(campaign->classes.names[i]));
    for (int i = 0; i < OUTPUT_KINDS; i++)
        if (plan->outputs & ~OUTPUT_ALWAYS & OUTPUT_BIT(i))
            json_append(&outputs, json_string(output_kinds[i].folder));
    for (size_t i = 0; i < plan->swath_count; i++) {
        const struct swath_plan *swath = &plan->swaths[i];
        json_append(
            &swaths,
            JSON_OBJECT({"path", json_string(swath->written)},
                        {"hash", json_string(campaign->swath_hashes[i])},
                        {"side", swath->side ? json_string(swath_side_word(swath)) : json_null()},
                        {"avoid", json_count(swath->avoid_count)},
                        {"left", json_number(crop_places_left(&swath->room))},
                        {"split", json_string(plan->splits[swath->split_number].name)},
                        {"jpeg_quality", swath->jpeg_quality > 0 ? json_integer(swath->jpeg_quality)
                                                                 : json_null()}));
    }
    return JSON_OBJECT(
        {"sonject_campaign", json_integer(FORMAT_VERSION)},
        {"sonject", json_string(sonject_version())}, {"hash", json_string(campaign->hash)},
        {"inputs", json_incref(campaign->inputs)}, {"images", json_count(plan->images)},
        {"empty", json_number(plan->empty)}, {"clutter_alone", json_number(plan->clutter_alone)},
        {"rows", side_of(plan->chip_rows)}, {"columns", side_of(plan->chip_columns)},
        {"splits", splits}, {"classes", classes}, {"outputs", outputs}, {"swaths", swaths});
}

/* Draws the swaths that have something to avoid, for the report: a merge has no swaths to draw. */
static sonject_status draw_swaths(struct sonject_campaign *campaign, const char *folder)
{
    struct report *report = campaign->report;
    char path[PATH_CAPACITY];
    for (uint32_t i = 0; i < campaign->campaign.swath_count; i++) {
        if (campaign->campaign.swaths[i].avoid_count == 0)
            continue;
        CHECK(path_in(report, path, folder, SWATHS_FOLDER));
        CHECK(folder_make(report, path));
        CHECK(path_in(report, path, folder, SWATHS_FOLDER "/%u.png", (unsigned)i));
        if (!file_exists(path))
            CHECK(campaign_draw_swath(campaign, i, path));
    }
    return SONJECT_OK;
}

/* Checks whose images the folder holds. overwrites: another campaign's are removed. */
static sonject_status check_head(struct sonject_campaign *campaign, const char *folder,
                                 bool overwrites, bool *is_same)
{
    struct data_set set;
    memset(&set, 0, sizeof set);
    sonject_status status = data_set_open(&set, campaign->report, folder);
    THEN(status, inputs_check(campaign->report, folder, json_object_get(set.head, "inputs"),
                              campaign->inputs, NULL, overwrites, is_same));
    if (status == SONJECT_OK && !*is_same)
        remove_all(&set);
    data_set_clear(&set);
    return status;
}

sonject_status data_set_begin(struct data_set *set, struct sonject_campaign *campaign,
                              const char *folder, bool overwrites)
{
    struct report *report = campaign->report;
    const struct campaign *plan = &campaign->campaign;
    bool is_same = false;
    char path[PATH_CAPACITY];
    CHECK(folder_make(report, folder));
    CHECK(path_in(report, path, folder, HEAD_FILE));
    sonject_status status = SONJECT_OK;
    if (file_exists(path))
        status = check_head(campaign, folder, overwrites, &is_same);
    if (status == SONJECT_OK && !is_same)
        status = json_document_write(report, status, head_of(campaign), 9, path);
    THEN(status, data_set_open(set, report, folder));
    THEN(status, draw_swaths(campaign, folder));
    for (size_t i = 0; status == SONJECT_OK && i < plan->split_count; i++)
        status = each_folder(report, folder, plan->splits[i].name, plan->outputs, folder_make);
    return status;
}

/* Returns whether a member is a text, not empty, that may stand in documents and on terminals. */
static bool has_plain(const json_t *object, const char *key)
{
    const char *text = member_text(object, key);
    return *text && text_is_printable(text);
}

/* Takes the splits' names and numbers of images, one split after the other. */
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

static bool are_classes(const json_t *classes)
{
    for (size_t i = 0; i < json_array_size(classes); i++) {
        const char *name = json_string_value(json_array_get(classes, i));
        if (!name || !*name || !text_is_printable(name))
            return false;
    }
    return json_is_array(classes) && json_array_size(classes) <= CLASSES_MAX;
}

static bool are_swaths(const json_t *swaths)
{
    for (size_t i = 0; i < json_array_size(swaths); i++) {
        const json_t *swath = json_array_get(swaths, i);
        if (!has_plain(swath, "path") || !has_plain(swath, "hash") ||
            !is_split_name(member_text(swath, "split")))
            return false;
    }
    return json_is_array(swaths);
}

static bool is_side(const json_t *head, const char *key)
{
    const json_int_t pixels = json_integer_value(json_object_get(head, key));
    return (pixels >= 1 && pixels <= CAMPAIGN_CHIP_MAX) ||
           strcmp(member_text(head, key), "all") == 0;
}

/* Reads the head. Returns false if a member that documents need is not as it should be. */
static bool read_head(struct data_set *set)
{
    size_t i;
    const json_t *name;
    const json_t *outputs = json_object_get(set->head, "outputs");
    set->outputs = OUTPUT_ALWAYS;
    json_array_foreach(outputs, i, name)
    {
        for (int kind = 0; json_is_string(name) && kind < OUTPUT_KINDS; kind++)
            if (strcmp(json_string_value(name), output_kinds[kind].folder) == 0)
                set->outputs |= OUTPUT_BIT(kind);
    }
    return json_is_integer(json_object_get(set->head, "sonject_campaign")) &&
           has_plain(set->head, "sonject") && has_plain(set->head, "hash") &&
           is_side(set->head, "rows") && is_side(set->head, "columns") && json_is_array(outputs) &&
           are_swaths(json_object_get(set->head, "swaths")) &&
           json_is_number(json_object_get(set->head, "empty")) &&
           json_is_number(json_object_get(set->head, "clutter_alone")) &&
           are_classes(json_object_get(set->head, "classes")) &&
           take_splits(set, json_object_get(set->head, "splits")) &&
           json_integer_value(json_object_get(set->head, "images")) == (json_int_t)set->images;
}

sonject_status data_set_open(struct data_set *set, struct report *report, const char *folder)
{
    char path[PATH_CAPACITY];
    set->report = report;
    set->folder = folder;
    CHECK(path_in(report, path, folder, HEAD_FILE));
    if (!file_exists(path))
        return input_failure(report, folder, "holds no campaign: there is no campaign.json");
    CHECK(json_document_read(report, path, &set->head));
    const json_t *version = json_object_get(set->head, "sonject_campaign");
    if (json_is_integer(version) && json_integer_value(version) != FORMAT_VERSION)
        return report_failure(
            report, SONJECT_ERROR_ARGUMENT,
            "%s: is of another version of sonject: choose another folder, or remove it", folder);
    return read_head(set)
               ? SONJECT_OK
               : input_failure(report, path, "damaged; remove it and run the campaign again");
}

void data_set_clear(struct data_set *set)
{
    json_decref(set->head);
    memset(set, 0, sizeof *set);
}

sonject_status data_set_is_finished(const struct data_set *set, bool *is_finished)
{
    const char *changed = NULL;
    const char *documents[DOCUMENTS];
    json_t *document;
    sonject_status status = earlier_document(set->report, set->folder, LAST_FILE, &document);
    const json_t *files = json_object_get(document, "files");
    THEN(status, file_list_check(files, set->report, set->folder, true, &changed));
    *is_finished =
        status == SONJECT_OK && !changed &&
        json_array_size(files) == name_documents(set->outputs, documents) + set->split_count &&
        strcmp(member_text(document, "hash"), member_text(set->head, "hash")) == 0;
    json_decref(document);
    return status;
}

#define MISSING_TOLD 24 /* missing images that are named by number */

static sonject_status check_complete(const struct data_set *set)
{
    uint64_t count = 0;
    struct growing_text text = {NULL, 0, 0, false};
    char changed[PATH_CAPACITY] = "";
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; i < set->split_count; i++)
        for (uint64_t k = 0; status == SONJECT_OK && k < set->split_images[i]; k++) {
            bool has = false;
            const uint64_t id = set->split_first[i] + k;
            status = data_set_has_image(set, i, id, changed, &has);
            if (status == SONJECT_OK && !has && count++ < MISSING_TOLD)
                growing_text_add(&text, "%s%" PRIu64, count > 1 ? ", " : "", id);
        }
    if (count > MISSING_TOLD)
        growing_text_add(&text, ", ...");
    char *ids = growing_text_end(&text);
    if (status == SONJECT_OK && count > 0)
        status =
            input_failure(set->report, set->folder,
                          "%" PRIu64 " of %" PRIu64
                          " images are missing%s: %s%s%s; run the campaign or its shards again",
                          count, set->images, *changed ? " or changed" : "", ids ? ids : "",
                          *changed ? "; not as it was written: " : "", changed);
    free(ids);
    return status;
}

/* A COCO document while it is written, list after list. */
struct coco_file {
    const struct data_set *set;
    size_t split;
    FILE *file;
    uint64_t entries; /* entries of the list so far */
};

static sonject_status add_text(struct coco_file *coco, const char *text)
{
    return fputs(text, coco->file) < 0
               ? file_failure(coco->set->report, coco->set->folder, "write coco.json below", errno)
               : SONJECT_OK;
}

/* Begins a list. The text also ends the list before. */
static sonject_status begin_list(struct coco_file *coco, const char *text)
{
    coco->entries = 0;
    return add_text(coco, text);
}

/* Adds the next entry of a list, and releases the entry. */
static sonject_status add_entry(struct coco_file *coco, json_t *entry)
{
    char *text = json_document_text(entry, JSON_COMPACT | JSON_REAL_PRECISION(9));
    json_decref(entry);
    CHECK_MEMORY(coco->set->report, text, "coco.json");
    sonject_status status = add_text(coco, coco->entries++ ? ",\n" : "\n");
    THEN(status, add_text(coco, text));
    free(text);
    return status;
}

static uint64_t side_told(const json_t *record, const char *key)
{
    return (uint64_t)json_integer_value(json_object_get(json_object_get(record, "swath"), key));
}

/* Adds an image's entry, or the image's annotations, which are numbered over the split. */
static sonject_status add_image(struct coco_file *coco, uint64_t id, bool has_annotations)
{
    json_t *record;
    const struct data_set *set = coco->set;
    CHECK(data_set_record(set, coco->split, id, &record));
    sonject_status status = SONJECT_OK;
    const json_t *list = has_annotations ? json_object_get(record, "annotations") : NULL;
    if (!has_annotations)
        status =
            add_entry(coco, coco_image(id, member_text(record, "image"), side_told(record, "rows"),
                                       side_told(record, "columns")));
    for (size_t i = 0; status == SONJECT_OK && i < json_array_size(list); i++) {
        json_t *annotation = json_array_get(list, i);
        if (json_is_object(annotation)) {
            json_incref(annotation);
            json_add(&annotation, "id", json_count(coco->entries + 1));
            json_add(&annotation, "image_id", json_count(id));
            status = add_entry(coco, annotation);
        } else {
            status = input_failure(set->report, set->folder,
                                   "the record of image %" PRIu64
                                   " is damaged; remove it and run the campaign again",
                                   id);
        }
    }
    json_decref(record);
    return status;
}

static sonject_status add_images(struct coco_file *coco, bool has_annotations)
{
    const struct data_set *set = coco->set;
    const uint64_t images = set->split_images[coco->split];
    for (uint64_t k = 0; k < images; k++) {
        const double done = 0.5 * (double)(k + (has_annotations ? images : 0));
        const double fraction =
            ((double)set->split_first[coco->split] + done) / (double)set->images;
        if (set->progress && set->progress(set->user, fraction, "documents") != 0)
            return report_failure(set->report, SONJECT_CANCELLED, "cancelled");
        CHECK(add_image(coco, set->split_first[coco->split] + k, has_annotations));
    }
    return SONJECT_OK;
}

/* Writes a split's document. Records are read twice, since annotations come behind all images. */
static sonject_status write_split(struct coco_file *coco)
{
    size_t i;
    const json_t *name;
    CHECK(begin_list(coco, "{\"info\": {\"description\": \"targets injected by sonject\", "
                           "\"version\": \""));
    CHECK(add_text(coco, sonject_version()));
    CHECK(add_text(coco, "\"},\n\"licenses\": [],\n\"images\": ["));
    CHECK(add_images(coco, false));
    CHECK(begin_list(coco, "],\n\"annotations\": ["));
    CHECK(add_images(coco, true));
    CHECK(begin_list(coco, "],\n\"categories\": ["));
    json_array_foreach(json_object_get(coco->set->head, "classes"), i, name)
    {
        CHECK(add_entry(coco, coco_category(i + 1, json_string_value(name))));
    }
    return add_text(coco, "]}\n");
}

static sonject_status write_coco(const struct data_set *set, size_t split)
{
    char path[PATH_CAPACITY];
    CHECK(path_in(set->report, path, set->folder, "%s/coco.json", set->split_names[split]));
    char *part = file_part_name(path);
    CHECK_MEMORY(set->report, part, "a file name");
    struct coco_file coco = {set, split, file_open(part, "wb"), 0};
    sonject_status status =
        coco.file ? write_split(&coco) : file_failure(set->report, path, "write", errno);
    if (coco.file && fclose(coco.file) != 0 && status == SONJECT_OK)
        status = file_failure(set->report, path, "write", errno);
    if (status == SONJECT_OK)
        status = file_publish(set->report, part, path);
    else
        file_discard(part);
    free(part);
    return status;
}

/* Writes classes.txt. YOLO numbers classes by their lines in this file. */
static sonject_status write_classes(const struct data_set *set)
{
    size_t i;
    const json_t *name;
    struct growing_text text = {NULL, 0, 0, false};
    char path[PATH_CAPACITY];
    CHECK(path_in(set->report, path, set->folder, "classes.txt"));
    json_array_foreach(json_object_get(set->head, "classes"), i, name)
    {
        growing_text_add(&text, "%s\n", json_string_value(name));
    }
    return growing_text_write(set->report, &text, path);
}

/* Writes dataset.json: a description of the whole, with size and hash of the documents of splits
 * and of the whole. */
static sonject_status write_last(const struct data_set *set)
{
    static const char *const kept[] = {"sonject", "hash",    "images",  "rows",  "columns",
                                       "splits",  "classes", "outputs", "swaths"};
    char name[SPLIT_NAME_CAPACITY + 16];
    char path[PATH_CAPACITY];
    const char *documents[DOCUMENTS];
    const size_t count = name_documents(set->outputs, documents);
    json_t *files = json_array();
    json_t *document = json_object();
    sonject_status status = path_in(set->report, path, set->folder, LAST_FILE);
    for (size_t i = 0; i < set->split_count; i++) {
        snprintf(name, sizeof name, "%s/coco.json", set->split_names[i]);
        THEN(status, file_list_add(&files, set->report, set->folder, name, false));
    }
    for (size_t i = 0; i < count; i++)
        THEN(status, file_list_add(&files, set->report, set->folder, documents[i], false));
    for (size_t i = 0; i < COUNT(kept); i++)
        json_add(&document, kept[i], json_incref(json_object_get(set->head, kept[i])));
    json_add(&document, "files", files);
    return json_document_write(set->report, status, document, 9, path);
}

sonject_status data_set_finish(struct data_set *set)
{
    struct report silent = {.host = NULL};
    char path[PATH_CAPACITY];
    CHECK(check_complete(set));
    for (size_t i = 0; i < set->split_count; i++)
        CHECK(write_coco(set, i));
    CHECK(write_classes(set));
    CHECK(write_report_page(set));
    if (set->outputs & OUTPUT_BIT(OUTPUT_YOLO))
        CHECK(write_yolo_card(set));
    const char *documents[DOCUMENTS];
    const size_t count = name_documents(set->outputs, documents);
    CHECK(write_croissant(set, documents, count - 1));
    CHECK(write_last(set));
    for (size_t i = 0; i < set->split_count; i++) {
        each_folder(&silent, set->folder, set->split_names[i], set->outputs, tidy);
        if (path_in(&silent, path, set->folder, "%s", set->split_names[i]) == SONJECT_OK)
            folder_tidy(path);
    }
    for (size_t i = 0; i < COUNT(numbered); i++)
        if (path_in(&silent, path, set->folder, "%s", numbered[i]) == SONJECT_OK)
            folder_tidy(path);
    folder_tidy(set->folder);
    return SONJECT_OK;
}
