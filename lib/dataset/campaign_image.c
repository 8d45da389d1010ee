/* One image of a campaign: made and written, and whether its files are as they were written: what a
 * record says is believed where its own hash holds. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "dataset/data_set.h"
#include "dataset/run.h"
#include "inject/scene_hash.h"
#include "schema/scene_file.h"
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

void campaign_image_clear(struct campaign_image *image)
{
    injection_result_clear(&image->result);
    swath_close(&image->swath);
    scene_clear(&image->scene);
    image_plan_clear(&image->plan);
}

/* The message of what failed, with the image's number before it. */
static sonject_status name_image(struct report *report, uint64_t id, sonject_status status)
{
    char message[REPORT_CAPACITY];
    if (status == SONJECT_OK || status == SONJECT_CANCELLED)
        return status;
    memcpy(message, report->message, sizeof message);
    return report_failure(report, status, "image %llu: %s", (unsigned long long)id, message);
}

/* What is said of "--set KEY: what" is the campaign file's where that drew the key. */
static bool place_line(struct tree *tree, const struct image_plan *plan, const char *line)
{
    static const char start[] = "--set ";
    if (strncmp(line, start, strlen(start)) != 0)
        return false;
    line += strlen(start);
    for (size_t i = plan->key_count; i-- > 0;) { /* what is drawn of an object comes behind it */
        const char *text = plan->keys[i].text;
        const size_t length = strcspn(text, "=");
        if (plan->keys[i].place.line == 0 || strncmp(line, text, length) != 0 || !line[length] ||
            !strchr(":.[", line[length]))
            continue;
        char key[256];
        const size_t end = strcspn(line, ":");
        struct tree table = {.report = tree->report,
                             .mistakes = tree->mistakes,
                             .file = plan->keys[i].table,
                             .named_at = {NULL, 1, 1}};
        snprintf(key, sizeof key, "%.*s", (int)end, line);
        tree_failure(table.file ? &table : tree, plan->keys[i].place, key, "%s",
                     line[end] ? line + end + 2 : line + end);
        return true;
    }
    return false;
}

static void place_message(struct sonject_campaign *campaign, const struct image_plan *plan)
{
    static const struct tree_place behind = {NULL, SIZE_MAX, 1};
    char message[REPORT_CAPACITY];
    struct mistakes mistakes = {0};
    struct tree *tree = &campaign->campaign.tree;
    memcpy(message, campaign->report->message, sizeof message);
    tree->mistakes = &mistakes;
    for (char *line = message, *next; *line; line = next) {
        next = line + strcspn(line, "\n");
        next += *next ? (*next = 0, 1) : 0;
        const char *key_end = strncmp(line, "--set ", 6) == 0 ? strstr(line, ": ") : NULL;
        const char *what = key_end ? key_end + 2 : line; /* nobody wrote that --set */
        if (!place_line(tree, plan, line))
            mistakes_add(&mistakes, tree, &behind, what, what);
    }
    tree->mistakes = NULL;
    mistakes_tell(&mistakes, campaign->report, SONJECT_ERROR_INPUT);
}

sonject_status campaign_read_base(struct sonject_campaign *campaign, const char *image,
                                  struct scene_source *source, struct scene *scene)
{
    const struct tree_node path = {.kind = TREE_TEXT, .is_quoted = true, .text = (char *)image};
    struct growing_text input = {NULL, 0, 0, false};
    growing_text_add(&input, "input.path=");
    tree_write_flow(&path, &input);
    char *text = growing_text_end(&input);
    CHECK_MEMORY(campaign->report, text, "an image's scene");
    source->overrides[source->override_count++] = text;
    source->path = campaign->campaign.scene_path;
    source->text = campaign->scene_text;
    source->moved_folder = campaign->campaign.folder;
    source->allows_user_shapes = campaign->allows_user_shapes;
    const sonject_status status = scene_source_read(source, campaign->report, scene);
    free(text);
    return status;
}

sonject_status campaign_read_scene(struct sonject_campaign *campaign, const struct image_plan *plan,
                                   struct scene *scene, bool *are_relations)
{
    struct scene_source source = {
        .overrides = allocate_array(plan->key_count + 1, sizeof *source.overrides),
        .override_count = plan->key_count,
        .moved_overrides = plan->key_count,
        .made_calibration = campaign->calibrations ? campaign->calibrations[plan->swath] : NULL,
        .are_relations = are_relations};
    CHECK_MEMORY(campaign->report, source.overrides, "an image's scene");
    for (size_t i = 0; i < plan->key_count; i++)
        source.overrides[i] = plan->keys[i].text;
    const sonject_status status =
        campaign_read_base(campaign, campaign->campaign.swaths[plan->swath].path, &source, scene);
    if (status != SONJECT_OK)
        place_message(campaign, plan);
    free(source.overrides);
    return status;
}

/* Keeps the first reason's first line; what goes on has not failed. */
static void keep_reason(struct report *report, const char *why, char reason[REASON_CAPACITY])
{
    if (!*reason)
        snprintf(reason, REASON_CAPACITY, "%.*s", (int)strcspn(why, "\n"), why);
    report->message[0] = '\0';
}

void campaign_forget_calibrations(struct sonject_campaign *campaign)
{
    for (size_t i = 0; campaign->calibrations && i < campaign->campaign.swath_count; i++)
        free(campaign->calibrations[i]);
    free(campaign->calibrations);
    campaign->calibrations = NULL;
}

sonject_status campaign_calibrate(struct sonject_campaign *campaign, const char *name,
                                  struct scene *scene, char path[PATH_CAPACITY])
{
    char folder[PATH_CAPACITY];
    struct mesh_store *meshes = scene->mesh_store;
    CHECK(path_in(campaign->report, folder, campaign->folder, CALIBRATIONS_FOLDER));
    CHECK(scene_calibrate(campaign->report, scene, folder, name, true, path));
    scene_clear(scene);
    scene_init(scene);
    scene->mesh_store = meshes;
    return SONJECT_OK;
}

sonject_status campaign_calibrate_swath(struct sonject_campaign *campaign, size_t swath,
                                        struct scene *scene)
{
    char path[PATH_CAPACITY], name[24];
    snprintf(name, sizeof name, "%zu", swath);
    if (campaign->calibrating)
        pthread_mutex_lock(campaign->calibrating);
    const sonject_status status = campaign_calibrate(campaign, name, scene, path);
    if (campaign->calibrating)
        pthread_mutex_unlock(campaign->calibrating);
    CHECK(status);
    if (!campaign->calibrations)
        campaign->calibrations =
            allocate_array(campaign->campaign.swath_count, sizeof *campaign->calibrations);
    CHECK_MEMORY(campaign->report, campaign->calibrations, "a campaign's calibrations");
    campaign->calibrations[swath] = copy_text(path);
    CHECK_MEMORY(campaign->report, campaign->calibrations[swath], "a campaign's calibrations");
    return SONJECT_OK;
}

sonject_status campaign_draw_scene(struct sonject_campaign *campaign, uint64_t id,
                                   struct attempts *attempts, char reason[REASON_CAPACITY],
                                   struct image_plan *plan, struct scene *scene)
{
    for (;; attempts_next(attempts)) {
        bool are_relations = false;
        sonject_status status =
            image_plan_make(campaign->report, &campaign->campaign, id, attempts, plan);
        THEN(status, campaign_read_scene(campaign, plan, scene, &are_relations));
        if (status == SONJECT_OK && scene->calibrates_itself && campaign->folder) {
            THEN(status, campaign_calibrate_swath(campaign, plan->swath, scene));
            THEN(status, campaign_read_scene(campaign, plan, scene, &are_relations));
        }
        if (status != SONJECT_ERROR_INPUT || !are_relations || attempts->of_all + 1 >= ATTEMPTS_MAX)
            return status;
        keep_reason(campaign->report, campaign->report->message, reason);
        image_plan_clear(plan);
    }
}

/* Calibrations are kept in a campaign's folder, which images in memory lack. */
static sonject_status check_calibrated(const struct sonject_campaign *campaign,
                                       const struct campaign_image *image)
{
    if (!image->scene.calibrates_itself)
        return SONJECT_OK;
    return scene_locate(
        &image->scene, campaign->report,
        report_failure(campaign->report, SONJECT_ERROR_INPUT,
                       "auto is for campaigns with a folder: make one image "
                       "by sonject campaign --only %llu -o FOLDER, and name "
                       "FOLDER/" CALIBRATIONS_FOLDER "/%u.yaml, which it leaves, instead of auto",
                       (unsigned long long)image->plan.id, (unsigned)image->plan.swath),
        "input.calibration");
}

/* *is_drawn: whether it failed for what was drawn. */
static sonject_status make_attempt(struct device *device, struct sonject_campaign *campaign,
                                   sonject_progress_function progress, void *user,
                                   struct campaign_image *image, bool *is_drawn)
{
    CHECK(swath_open_stored(campaign->report, &image->scene, &campaign->store, &image->swath));
    const struct injection_input input = swath_input(&image->swath);
    const sonject_status status = injection_run(campaign->report, device, &image->scene, &input,
                                                progress, user, &image->result);
    *is_drawn = status == SONJECT_ERROR_INPUT;
    if (*is_drawn)
        place_message(campaign, &image->plan);
    else if (status == SONJECT_OK) {
        swath_leave_empty(&image->swath, &image->result);
        image->result.statistics.input_clipped = image->swath.clipped;
    }
    return status;
}

static bool is_faint(const struct campaign *campaign, const sonject_object_truth *truth)
{
    return (!isnan(campaign->visible_highlight_db) &&
            !(truth->highlight_visibility_db >= campaign->visible_highlight_db)) ||
           (!isnan(campaign->visible_shadow_db) &&
            !(truth->shadow_visibility_db <= campaign->visible_shadow_db));
}

/* Finds the targets that are seen less than they are to be; false: there are none. next: of several
 * targets those alone are drawn anew, and all others keep their places. */
static bool find_faint(const struct sonject_campaign *campaign, struct campaign_image *image,
                       struct attempts *next, char why[REASON_CAPACITY])
{
    const struct image_plan *plan = &image->plan;
    struct object_places places = plan->places;
    bool are_some = false;
    for (uint32_t i = 0; i < plan->object_count; i++)
        places.are_kept[i] = true;
    for (uint32_t i = 0; i < plan->target_count; i++) {
        const sonject_object_truth *truth = &image->result.objects[i];
        image->is_faint[i] = is_faint(&campaign->campaign, truth);
        if (!image->is_faint[i])
            continue;
        are_some = true;
        places.are_kept[i] = false;
        next->of_targets[i] += plan->target_count > 1;
        snprintf(why, REASON_CAPACITY,
                 "the target is seen too little: highlight %.1f dB, shadow %.1f dB",
                 truth->highlight_visibility_db, truth->shadow_visibility_db);
    }
    if (plan->target_count > 1)
        next->places = places;
    else if (are_some)
        attempts_next(next);
    return are_some;
}

sonject_status campaign_image_make(struct device *device, struct sonject_campaign *campaign,
                                   uint64_t id, sonject_progress_function progress, void *user,
                                   struct campaign_image *image)
{
    struct attempts attempts = {0};
    uint32_t redrawn = 0; /* for targets alone */
    char reason[REASON_CAPACITY] = "";
    for (;;) {
        bool is_drawn = false;
        scene_init(&image->scene);
        image->scene.mesh_store = &campaign->meshes;
        sonject_status status =
            campaign_draw_scene(campaign, id, &attempts, reason, &image->plan, &image->scene);
        THEN(status, check_calibrated(campaign, image));
        THEN(status, make_attempt(device, campaign, progress, user, image, &is_drawn));
        const uint32_t given_up = attempts.of_all + redrawn;
        struct attempts next = attempts;
        char too_faint[REASON_CAPACITY];
        if (is_drawn)
            attempts_next(&next);
        if (status == SONJECT_OK && find_faint(campaign, image, &next, too_faint))
            is_drawn = campaign->campaign.faint == FAINT_REDRAW && given_up + 1 < ATTEMPTS_MAX;
        if (!is_drawn || given_up + 1 >= ATTEMPTS_MAX) {
            image->attempts = given_up;
            strcpy(image->reason, reason);
            return name_image(campaign->report, id, status);
        }
        redrawn += next.of_all == attempts.of_all;
        attempts = next;
        keep_reason(campaign->report, status == SONJECT_OK ? too_faint : campaign->report->message,
                    reason);
        campaign_image_clear(image);
        memset(image, 0, sizeof *image);
    }
}

/* Rows of the track become those of the image. */
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

/* The image as one by itself: its own pixel (0, 0) is where its geometry begins, and its track.
 * What the two hold is the image's. */
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
    swath->skipped.count = 0; /* they are the recording's */
}

static sonject_status write_pixels(struct sonject_campaign *campaign, const struct scene *scene,
                                   struct swath *swath, struct injection_result *result,
                                   int quality, const char *path)
{
    static const char *const complex_names[] = {"real", "imag"};
    struct geometry_notes notes;
    void *stored = swath_stored_result(swath, result, &result->statistics.output_clipped);
    CHECK_MEMORY(campaign->report, stored, "an image");
    geometry_notes_init(&notes, &scene->sonar, &scene->geometry);
    const sonject_status status =
        quality > 0 ? raster_file_write_jpeg(campaign->report, path, &swath->layout,
                                             notes.attributes, notes.count, stored, quality)
                    : raster_file_write(campaign->report, path, &swath->layout,
                                        swath->is_complex ? complex_names : NULL, notes.attributes,
                                        notes.count, stored);
    free(stored);
    return status;
}

/* What images, truth and labels are made of. */
struct image_parts {
    struct scene scene;
    struct swath swath;
    struct image_labels labels;
    char folder[PATH_CAPACITY]; /* of the split */
    const char *extension;      /* of pixels */
};

static json_t *record_of(const struct sonject_campaign *campaign,
                         const struct campaign_image *image, const struct image_parts *parts,
                         const char *scene_hash_text, json_t *files)
{
    const struct image_plan *plan = &image->plan;
    const struct campaign *drawn = &campaign->campaign;
    const bool has_target = plan->category >= CATEGORY_TARGET;
    json_t *keys = json_array();
    for (size_t i = 0; i < plan->key_count; i++)
        json_append(&keys, json_string(plan->keys[i].text));
    json_t *place = JSON_OBJECT(
        {"path", json_string(drawn->swaths[plan->swath].written)},
        {"hash", json_string(campaign->swath_hashes[plan->swath])},
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
    if (status == SONJECT_OK)
        return json_document_write(campaign->report, record, 9, path);
    json_decref(record);
    return status;
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
                                    .jpeg_quality = jpeg_quality_of(campaign, image)};
    static const enum layer layers[OUTPUT_KINDS] = {
        [OUTPUT_HIGHLIGHT] = LAYER_HIGHLIGHT, [OUTPUT_SHADOW] = LAYER_SHADOW,
        [OUTPUT_MASKS] = LAYER_LABELS,        [OUTPUT_INFLUENCE] = LAYER_INFLUENCE,
        [OUTPUT_ENERGY] = LAYER_ENERGY,       [OUTPUT_FIELD] = LAYER_FIELD};
    switch (output) {
    case OUTPUT_IMAGE:
        return write_pixels(campaign, &parts->scene, &parts->swath, result, facts.jpeg_quality,
                            path);
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
    const bool is_grey = layout->type == PIXEL_UINT8 && !parts.swath.is_complex;
    parts.extension = jpeg_quality_of(campaign, image) > 0 ? ".jpg" : is_grey ? ".png" : ".tif";
    char image_name[IMAGE_NAME_CAPACITY];
    const struct label_request request = {
        &parts.scene,
        &image->result,
        image_file_name(id, OUTPUT_IMAGE, parts.extension, image_name),
        layout->rows,
        layout->columns,
        parts.swath.patch,
        &parts.swath.track};
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

/* Errors: INPUT (it was changed, or is another image's), MEMORY. */
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
    const char *name = NULL; /* of the first file that is not as it was written */
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
