/* One image of a campaign: made, written, looked for. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include <sonject/version.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "dataset/campaign_files.h"
#include "dataset/campaign_handle.h"
#include "dataset/documents.h"
#include "dataset/label_files.h"
#include "dataset/labels.h"
#include "inject/scene_hash.h"
#include "schema/scene_file.h"
#include "schema/yaml_tree.h"
#include "swath/geometry_notes.h"
#include "swath/raster_file.h"

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

/* What is said of "--set KEY: what" is the campaign file's where that drew the key.
 */
static bool place_line(struct tree *tree, const struct image_plan *plan, const char *line)
{
    static const char start[] = "--set ";
    if (strncmp(line, start, strlen(start)) != 0)
        return false;
    line += strlen(start);
    for (size_t i = 0; i < plan->key_count; i++) {
        const char *text = plan->keys[i].text;
        const size_t length = strcspn(text, "=");
        if (plan->keys[i].place.line == 0 || strncmp(line, text, length) != 0 ||
            !strchr(":.[", line[length]))
            continue;
        char key[256];
        const size_t end = strcspn(line, ":");
        snprintf(key, sizeof key, "%.*s", (int)end, line);
        tree_failure(tree, plan->keys[i].place, key, "%s", line + end + (line[end] == ':') + 1);
        return true;
    }
    return false;
}

static void place_message(struct sonject_campaign *campaign, const struct image_plan *plan)
{
    static const struct tree_place behind = {NULL, SIZE_MAX, 1};
    char message[REPORT_CAPACITY];
    struct mistakes mistakes = {NULL, 0, 0, 0};
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

sonject_status campaign_read_scene(struct sonject_campaign *campaign, const struct image_plan *plan,
                                   struct scene *scene)
{
    const struct swath_plan *swath = &campaign->campaign.swaths[plan->swath];
    const struct tree_node path = {.kind = TREE_TEXT, .is_quoted = true, .text = swath->path};
    struct growing_text input = {NULL, 0, 0, false};
    const char **overrides = allocate_array(plan->key_count + 1, sizeof *overrides);
    growing_text_add(&input, "input.path=");
    tree_write_flow(&path, &input);
    char *input_text = growing_text_end(&input);
    sonject_status status = overrides && input_text
                                ? SONJECT_OK
                                : report_out_of_memory(campaign->report, "an image's scene");
    if (status == SONJECT_OK) {
        for (size_t i = 0; i < plan->key_count; i++)
            overrides[i] = plan->keys[i].text;
        overrides[plan->key_count] = input_text;
        const struct scene_text source = {.path = campaign->campaign.scene_path,
                                          .text = campaign->scene_text,
                                          .bytes = campaign->scene_bytes,
                                          .overrides = overrides,
                                          .override_count = plan->key_count + 1,
                                          .moved_folder = campaign->campaign.folder,
                                          .moved_overrides = plan->key_count,
                                          .allows_user_shapes = campaign->allows_user_shapes};
        status = scene_text_read(campaign->report, &source, scene);
        if (status != SONJECT_OK)
            place_message(campaign, plan);
    }
    free(overrides);
    free(input_text);
    return status;
}

sonject_status campaign_image_make(struct device *device, struct sonject_campaign *campaign,
                                   uint64_t id, sonject_progress_function progress, void *user,
                                   struct campaign_image *image)
{
    scene_init(&image->scene);
    image->scene.mesh_store = &campaign->meshes;
    sonject_status status =
        image_plan_make(campaign->report, &campaign->campaign, id, &image->plan);
    THEN(status, campaign_read_scene(campaign, &image->plan, &image->scene));
    if (status == SONJECT_OK) {
        status =
            swath_open_stored(campaign->report, &image->scene, &campaign->store, &image->swath);
        const struct injection_input input = swath_input(&image->swath);
        THEN(status, injection_run(campaign->report, device, &image->scene, &input, progress, user,
                                   &image->result));
        if (status == SONJECT_ERROR_INPUT)
            place_message(campaign, &image->plan);
    }
    if (status == SONJECT_OK)
        image->result.statistics.input_clipped = image->swath.clipped;
    return name_image(campaign->report, id, status);
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
    *scene = image->scene;
    *swath = image->swath;
    scene->geometry.first_along_track_m += (double)chip->first_row * scene->geometry.row_spacing_m;
    scene->geometry.first_slant_range_m +=
        (double)chip->first_column * scene->geometry.column_spacing_m;
    swath->layout.rows = chip->rows;
    swath->layout.columns = chip->columns;
    swath->patch = all;
}

static sonject_status write_pixels(struct sonject_campaign *campaign, const struct scene *scene,
                                   struct swath *swath, struct injection_result *result,
                                   const char *path)
{
    static const char *const complex_names[] = {"real", "imag"};
    struct geometry_notes notes;
    void *stored = swath_stored_result(swath, result, &result->statistics.output_clipped);
    CHECK_MEMORY(campaign->report, stored, "an image");
    geometry_notes_init(&notes, &scene->sonar, &scene->geometry, 0.0, 0.0);
    const sonject_status status = raster_file_write(campaign->report, path, &swath->layout,
                                                    swath->is_complex ? complex_names : NULL,
                                                    notes.attributes, notes.count, stored);
    free(stored);
    return status;
}

static sonject_status write_mask(struct sonject_campaign *campaign, const struct swath *swath,
                                 const struct injection_result *result, uint32_t output,
                                 const char *path)
{
    const struct raster_layout layout = {swath->layout.rows, swath->layout.columns, 1, PIXEL_UINT8};
    const struct region all = {0, 0, layout.rows, layout.columns};
    if (output != OUTPUT_HIGHLIGHT && output != OUTPUT_SHADOW)
        return write_label_mask(campaign->report, swath, &all, result->labels, path);
    return raster_file_write_placed(campaign->report, path, &layout, &all,
                                    output == OUTPUT_HIGHLIGHT ? result->highlight : result->shadow,
                                    NULL);
}

/* Energy and field. */
static sonject_status write_layer(struct sonject_campaign *campaign, const struct scene *scene,
                                  const struct swath *swath, const struct injection_result *result,
                                  uint32_t output, const char *path)
{
    static const char *const complex_names[] = {"real", "imag"};
    struct geometry_notes notes;
    struct raster_layout layout = {swath->layout.rows, swath->layout.columns, 1, PIXEL_FLOAT32};
    layout.channels = output == OUTPUT_FIELD ? 2 : 1;
    geometry_notes_init(&notes, &scene->sonar, &scene->geometry, 0.0, 0.0);
    return raster_file_write(campaign->report, path, &layout,
                             layout.channels == 2 ? complex_names : NULL, notes.attributes,
                             notes.count, output == OUTPUT_FIELD ? result->field : result->energy);
}

/* Annotations are numbered when all images are known. */
static json_t *record_of(const struct sonject_campaign *campaign,
                         const struct campaign_image *image, const char *image_name,
                         const char *scene_hash_text, json_t *files, json_t *annotations)
{
    const struct image_plan *plan = &image->plan;
    const struct swath_plan *swath = &campaign->campaign.swaths[plan->swath];
    const bool has_target = plan->category >= CATEGORY_TARGET;
    json_t *keys = json_array();
    for (size_t i = 0; i < plan->key_count; i++)
        json_append(&keys, json_string(plan->keys[i].text));
    json_t *place = JSON_OBJECT(
        {"path", json_string(swath->written)},
        {"hash", json_string(campaign->swath_hashes[plan->swath])},
        {"row", json_count(plan->chip.first_row)}, {"column", json_count(plan->chip.first_column)},
        {"rows", json_count(plan->chip.rows)}, {"columns", json_count(plan->chip.columns)});
    return JSON_OBJECT(
        {"id", json_count(plan->id)},
        {"split", json_string(campaign->campaign.splits[plan->split].name)},
        {"image", json_string(image_name)},
        {"target",
         has_target
             ? json_string(campaign->campaign.targets[plan->category - CATEGORY_TARGET].class_name)
             : json_null()},
        {"swath", place}, {"seed", json_seed(image->scene.injection.seed)},
        {"scene", json_string(campaign->campaign.scene_written)}, {"set", keys},
        {"scene_hash", json_string(scene_hash_text)},
        {"campaign_hash", json_string(campaign->hash)}, {"sonject", json_string(sonject_version())},
        {"files", files}, {"annotations", annotations});
}

static sonject_status write_record(struct sonject_campaign *campaign,
                                   const struct campaign_image *image,
                                   const struct image_labels *labels,
                                   const struct image_files *files)
{
    char hash[HASH_TEXT_CAPACITY];
    json_t *list;
    CHECK(scene_hash(campaign->report, &image->scene, image->swath.identity, hash));
    CHECK(image_files_list(files, campaign->report, &list));
    return json_document_write(
        campaign->report,
        record_of(campaign, image, labels->file_name, hash, list, coco_annotations(labels)), 9,
        files->record);
}

static sonject_status write_output(struct sonject_campaign *campaign,
                                   const struct campaign_image *image, const struct scene *scene,
                                   const struct swath *swath, const struct image_labels *labels,
                                   uint32_t output, const char *path)
{
    switch (output) {
    case OUTPUT_YOLO:
        return labels_write(campaign->report, labels, &campaign->classes, LABEL_YOLO, path);
    case OUTPUT_VOC:
        return labels_write(campaign->report, labels, &campaign->classes, LABEL_VOC, path);
    case OUTPUT_ENERGY:
    case OUTPUT_FIELD:
        return write_layer(campaign, scene, swath, &image->result, output, path);
    default:
        return write_mask(campaign, swath, &image->result, output, path);
    }
}

/* All but the image itself. */
static sonject_status write_rest(struct sonject_campaign *campaign,
                                 const struct campaign_image *image, const struct scene *scene,
                                 const struct swath *swath, const struct image_labels *labels,
                                 const struct image_files *files)
{
    const struct run_facts facts = {
        .scene = scene, .swath = swath, .result = &image->result, .image_name = labels->file_name};
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < files->output_count; i++)
        status = write_output(campaign, image, scene, swath, labels, files->outputs[i].kind->output,
                              files->outputs[i].path);
    THEN(status, write_truth(campaign->report, &facts, files->truth));
    THEN(status, write_record(campaign, image, labels, files));
    return status;
}

sonject_status campaign_image_write(struct sonject_campaign *campaign, struct campaign_image *image,
                                    const char *folder)
{
    struct scene scene;
    struct swath swath;
    struct image_labels labels;
    struct image_files files;
    char image_name[64];
    const char *split = campaign->campaign.splits[image->plan.split].name;
    take_alone(image, &scene, &swath);
    snprintf(image_name, sizeof image_name, "images/%08llu%s", (unsigned long long)image->plan.id,
             image_extension(swath.layout.type, swath.is_complex));
    const struct label_request request = {
        &scene,      &image->result, image_name, swath.layout.rows, swath.layout.columns,
        swath.patch, &swath.track};
    CHECK(image_labels_find(&labels, campaign->report, &request, &campaign->classes));
    sonject_status status =
        image_files_init(&files, campaign->report, folder, split, image->plan.id, swath.layout.type,
                         swath.is_complex, campaign->campaign.outputs);
    THEN(status, write_pixels(campaign, &scene, &swath, &image->result, files.image));
    THEN(status, write_rest(campaign, image, &scene, &swath, &labels, &files));
    image_files_clear(&files);
    image_labels_clear(&labels);
    return status;
}
