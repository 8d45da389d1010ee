/* The files of one image of a campaign, and the check that they are as they were written. A record
 * is trusted if its own hash holds. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/file.h"
#include "base/json_document.h"
#include "dataset/data_set.h"
#include "dataset/labels.h"
#include "dataset/run.h"
#include "inject/scene_hash.h"
#include "swath/geometry_notes.h"
#include "swath/raster_file.h"

const struct output_kind output_kinds[OUTPUT_KINDS] = {
    [OUTPUT_IMAGE] = {"images", NULL},          [OUTPUT_TRUTH] = {"truth", ".json"},
    [OUTPUT_HIGHLIGHT] = {"highlight", ".png"}, [OUTPUT_SHADOW] = {"shadow", ".png"},
    [OUTPUT_MASKS] = {"masks", ".png"},         [OUTPUT_INFLUENCE] = {"influence", ".png"},
    [OUTPUT_ENERGY] = {"energy", ".tif"},       [OUTPUT_FIELD] = {"field", ".tif"},
    [OUTPUT_YOLO] = {"labels", ".txt"},         [OUTPUT_VOC] = {"voc", ".xml"},
    [OUTPUT_RECORD] = {"records", ".json"},
};

const char *image_file_name(uint64_t id, enum output output, const char *extension,
                            char name[IMAGE_NAME_CAPACITY])
{
    const struct output_kind *kind = &output_kinds[output];
    snprintf(name, IMAGE_NAME_CAPACITY, "%s/%08" PRIu64 "%s", kind->folder, id,
             kind->extension ? kind->extension : extension);
    return name;
}

/* Moves the track's rows so that they count from the image's first row. */
static void shift_track(struct track *track, uint64_t first_row)
{
    const uint64_t shift = first_row < track->rows ? first_row : track->rows;
    for (size_t i = 0; i < track->fix_count; i++)
        track->fixes[i].row -= (double)first_row;
    track->rows -= shift;
    if (track->headings_deg)
        memmove(track->headings_deg, track->headings_deg + shift,
                (size_t)track->rows * sizeof *track->headings_deg);
}

/* Makes scene and swath of the image by itself: its geometry and its track begin at its own pixel
 * (0, 0). What scene and swath hold stays owned by the image. */
static void take_alone(struct campaign_image *image, struct scene *scene, struct swath *swath)
{
    const struct region *chip = &image->plan.chip;
    const struct region all = {0, 0, chip->rows, chip->columns};
    shift_track(&image->swath.track, chip->first_row);
    for (uint64_t i = 0; i < image->swath.empty.count; i++)
        image->swath.empty.numbers[i] -= chip->first_row;
    *scene = image->scene;
    *swath = image->swath;
    scene->geometry = geometry_crop(&image->scene.geometry, (double)chip->first_row,
                                    (double)chip->first_column, (double)chip->columns);
    swath->layout.rows = chip->rows;
    swath->layout.columns = chip->columns;
    swath->patch = all;
    swath->skipped.count = 0; /* skipped pings belong to the whole recording */
}

static bool is_grey(const struct sonject_campaign *campaign)
{
    return !isnan(campaign->campaign.grey_db[0]);
}

/* noting: where grey levels that suit few pixels are told, or NULL. */
static sonject_status write_pixels(struct sonject_campaign *campaign, struct report *noting,
                                   const struct scene *scene, struct swath *swath,
                                   struct injection_result *result, int quality, const char *path)
{
    static const char *const complex_names[] = {"real", "imag"};
    struct raster_attribute attributes[GEOMETRY_NOTES_MAX + 1];
    struct geometry_notes notes;
    char ends[GREY_TEXT], full_scale[32];
    void *stored = swath_stored_result(swath, result, &result->statistics.output_clipped);
    CHECK_MEMORY(campaign->report, stored, "an image");
    geometry_notes_init(&notes, &scene->sonar, &scene->geometry);
    size_t count = notes.count;
    memcpy(attributes, notes.attributes, count * sizeof *attributes);
    struct raster_layout layout = swath->layout;
    const char *const *names = swath->is_complex ? complex_names : NULL;
    if (is_grey(campaign)) {
        attributes[count++] = raster_make_grey(noting, &layout, stored, swath->full_scale,
                                               campaign->campaign.grey_db, ends);
        names = NULL;
    } else if (swath->full_scale < pixel_full_scale(layout.type) ||
               swath->full_scale > pixel_full_scale(layout.type)) {
        snprintf(full_scale, sizeof full_scale, "%.0f", swath->full_scale);
        attributes[count++] = (struct raster_attribute){FULL_SCALE_NOTE, full_scale};
    }
    const sonject_status status =
        quality > 0
            ? raster_file_write_jpeg(campaign->report, path, &layout, attributes, count, stored,
                                     quality)
            : raster_file_write(campaign->report, path, &layout, names, attributes, count, stored);
    free(stored);
    return status;
}

/* The parts that images, truth and labels are made of. */
struct image_parts {
    struct scene scene;
    struct swath swath;
    struct image_labels labels;
    char folder[PATH_CAPACITY]; /* folder of the split */
    const char *extension;      /* extension of the image file */
};

static json_t *record_of(const struct sonject_campaign *campaign,
                         const struct campaign_image *image, const struct image_parts *parts,
                         const char *scene_hash_text, json_t *files)
{
    const struct image_plan *plan = &image->plan;
    const struct campaign *drawn = &campaign->campaign;
    const bool has_target = plan->category >= CATEGORY_TARGET;
    const char *path = drawn->swaths[plan->swath].written;
    char *input = input_override(path);
    json_t *keys = json_array();
    json_append(&keys, input ? json_string(input) : NULL);
    free(input);
    for (size_t i = 0; i < plan->key_count; i++)
        json_append(&keys, json_string(plan->keys[i].text));
    json_t *place = JSON_OBJECT(
        {"path", json_string(path)}, {"hash", json_string(campaign->swath_hashes[plan->swath])},
        {"row", json_count(plan->chip.first_row)}, {"column", json_count(plan->chip.first_column)},
        {"rows", json_count(plan->chip.rows)}, {"columns", json_count(plan->chip.columns)});
    return JSON_OBJECT(
        {"id", json_count(plan->id)}, {"split", json_string(drawn->splits[plan->split].name)},
        {"image", json_string(parts->labels.file_name)},
        {"target", has_target
                       ? json_string(drawn->targets[plan->category - CATEGORY_TARGET].class_name)
                       : json_null()},
        {"targets", json_count(plan->target_count)}, {"swath", place},
        {"seed", json_seed(image->scene.injection.seed)},
        {"scene", json_string(drawn->scene_written)}, {"set", keys},
        {"scene_hash", json_string(scene_hash_text)},
        {"campaign_hash", json_string(campaign->hash)}, {"sonject", json_string(sonject_version())},
        {"files", files}, {"annotations", coco_annotations(&parts->labels)});
}

static sonject_status write_record(struct sonject_campaign *campaign,
                                   const struct campaign_image *image,
                                   const struct image_parts *parts, const char *path)
{
    char hash[HASH_TEXT_CAPACITY];
    char name[IMAGE_NAME_CAPACITY];
    CHECK(scene_hash(campaign->report, &image->scene, image->swath.identity, hash));
    sonject_status status = SONJECT_OK;
    json_t *list = json_array();
    for (int i = 0; i < OUTPUT_RECORD; i++)
        if (campaign->campaign.outputs & OUTPUT_BIT(i))
            THEN(status, file_list_add(&list, campaign->report, parts->folder,
                                       image_file_name(image->plan.id, (enum output)i,
                                                       parts->extension, name),
                                       false));
    json_t *record = record_of(campaign, image, parts, hash, list);
    if (image->attempts > 0)
        json_add(&record, "drawn_anew",
                 JSON_OBJECT({"times", json_count(image->attempts)},
                             {"because", json_text(image->reason)}));
    THEN(status, json_document_hash(campaign->report, record, JSON_COMPACT, hash));
    json_add(&record, "xxh3", json_string(hash));
    return json_document_write(campaign->report, status, record, 9, path);
}

static int jpeg_quality_of(const struct sonject_campaign *campaign,
                           const struct campaign_image *image)
{
    return campaign->campaign.swaths[image->plan.swath].jpeg_quality;
}

static sonject_status write_file(struct sonject_campaign *campaign, struct campaign_image *image,
                                 struct image_parts *parts, enum output output, const char *path)
{
    struct report *report = campaign->report;
    struct injection_result *result = &image->result;
    const struct run_facts facts = {.scene = &parts->scene,
                                    .swath = &parts->swath,
                                    .result = result,
                                    .image_name = parts->labels.file_name,
                                    .chip = &image->plan.chip,
                                    .whole = &image->swath.layout,
                                    .jpeg_quality = jpeg_quality_of(campaign, image)};
    static const enum layer layers[OUTPUT_KINDS] = {
        [OUTPUT_HIGHLIGHT] = LAYER_HIGHLIGHT, [OUTPUT_SHADOW] = LAYER_SHADOW,
        [OUTPUT_MASKS] = LAYER_LABELS,        [OUTPUT_INFLUENCE] = LAYER_INFLUENCE,
        [OUTPUT_ENERGY] = LAYER_ENERGY,       [OUTPUT_FIELD] = LAYER_FIELD};
    switch (output) {
    case OUTPUT_IMAGE:
        return write_pixels(campaign, image->plan.id == 0 ? report : NULL, &parts->scene,
                            &parts->swath, result, facts.jpeg_quality, path);
    case OUTPUT_TRUTH:
        return write_truth(report, &facts, path);
    case OUTPUT_YOLO:
        return labels_write(report, &parts->labels, &campaign->classes, LABEL_YOLO, path);
    case OUTPUT_VOC:
        return labels_write(report, &parts->labels, &campaign->classes, LABEL_VOC, path);
    case OUTPUT_RECORD:
        return write_record(campaign, image, parts, path);
    default:
        return write_layer(report, &facts, layers[output], path);
    }
}

sonject_status campaign_image_write(struct sonject_campaign *campaign, struct campaign_image *image,
                                    const char *folder)
{
    struct report *report = campaign->report;
    const uint64_t id = image->plan.id;
    struct image_parts parts;
    char name[IMAGE_NAME_CAPACITY];
    char path[PATH_CAPACITY];
    CHECK(path_in(report, parts.folder, folder, "%s",
                  campaign->campaign.splits[image->plan.split].name));
    take_alone(image, &parts.scene, &parts.swath);
    const struct raster_layout *layout = &parts.swath.layout;
    const bool has_bytes =
        is_grey(campaign) || (layout->type == PIXEL_UINT8 && !parts.swath.is_complex);
    parts.extension = jpeg_quality_of(campaign, image) > 0 ? ".jpg" : has_bytes ? ".png" : ".tif";
    char image_name[IMAGE_NAME_CAPACITY];
    const struct label_request request = {
        &parts.scene,
        &image->result,
        image_file_name(id, OUTPUT_IMAGE, parts.extension, image_name),
        layout->rows,
        layout->columns,
        parts.swath.patch,
        &parts.swath.track,
        campaign->campaign.clutter_labelled ? image->result.object_count
                                            : image->plan.target_count};
    CHECK(image_labels_find(&parts.labels, report, &request, &campaign->classes));
    for (uint32_t i = 0; i < image->plan.target_count; i++)
        parts.labels.contacts[i].is_difficult = image->is_faint[i];
    sonject_status status = SONJECT_OK;
    for (int i = 0; status == SONJECT_OK && i < OUTPUT_KINDS; i++)
        if (campaign->campaign.outputs & OUTPUT_BIT(i)) {
            status = path_in(report, path, parts.folder, "%s",
                             image_file_name(id, (enum output)i, parts.extension, name));
            THEN(status, write_file(campaign, image, &parts, (enum output)i, path));
        }
    image_labels_clear(&parts.labels);
    return status;
}

/* Checks a record. Errors: INPUT (the record was changed, or is another image's), MEMORY. */
static sonject_status check_record(const struct data_set *set, size_t split, uint64_t id,
                                   json_t *record, const char *path)
{
    char told[HASH_TEXT_CAPACITY], hash[HASH_TEXT_CAPACITY];
    char name[IMAGE_NAME_CAPACITY];
    const char *image = member_text(record, "image");
    snprintf(told, sizeof told, "%s", member_text(record, "xxh3"));
    json_object_del(record, "xxh3");
    CHECK(json_document_hash(set->report, record, JSON_COMPACT, hash));
    const char *extension = strstr(image, ".tif")   ? ".tif"
                            : strstr(image, ".jpg") ? ".jpg"
                                                    : ".png";
    image_file_name(id, OUTPUT_IMAGE, extension, name);
    if (strcmp(told, hash) == 0 && strcmp(image, name) == 0 &&
        strcmp(member_text(record, "campaign_hash"), member_text(set->head, "hash")) == 0 &&
        strcmp(member_text(record, "split"), set->split_names[split]) == 0)
        return SONJECT_OK;
    return input_failure(
        set->report, path,
        "was changed, or is another image's; remove it and run the campaign again");
}

sonject_status data_set_record(const struct data_set *set, size_t split, uint64_t id,
                               json_t **record)
{
    char path[PATH_CAPACITY];
    char name[IMAGE_NAME_CAPACITY];
    *record = NULL;
    CHECK(path_in(set->report, path, set->folder, "%s/%s", set->split_names[split],
                  image_file_name(id, OUTPUT_RECORD, NULL, name)));
    CHECK(json_document_read(set->report, path, record));
    const sonject_status status = check_record(set, split, id, *record, path);
    if (status != SONJECT_OK) {
        json_decref(*record);
        *record = NULL;
    }
    return status;
}

sonject_status data_set_has_image(const struct data_set *set, size_t split, uint64_t id,
                                  char changed[PATH_CAPACITY], bool *has)
{
    char folder[PATH_CAPACITY], path[PATH_CAPACITY];
    char record_name[IMAGE_NAME_CAPACITY];
    json_t *record;
    const char *name = NULL; /* first file that is not as it was written */
    *has = false;
    CHECK(path_in(set->report, folder, set->folder, "%s", set->split_names[split]));
    CHECK(path_in(set->report, path, folder, "%s",
                  image_file_name(id, OUTPUT_RECORD, NULL, record_name)));
    if (!file_exists(path))
        return SONJECT_OK;
    sonject_status status = data_set_record(set, split, id, &record);
    if (status == SONJECT_ERROR_INPUT) {
        set->report->message[0] = '\0';
        status = SONJECT_OK;
        name = record_name;
    } else {
        THEN(status,
             file_list_check(json_object_get(record, "files"), set->report, folder, true, &name));
    }
    *has = status == SONJECT_OK && !name;
    if (status == SONJECT_OK && name && changed && !*changed)
        status = path_in(set->report, changed, folder, "%s", name);
    json_decref(record);
    return status;
}
