/* The check that all scenes of a campaign can be made, and the hash of all that images depend on. A
 * trial is a scene at one end of all distributions, read but not injected. */
#include <stdio.h>
#include <stdlib.h>

#include <sonject/version.h>

#include "base/json_document.h"
#include "base/memory.h"
#include "base/text.h"
#include "dataset/campaign.h"
#include "dataset/run.h"
#include "inject/scene_hash.h"
#include "schema/scene_file.h"
#include "swath/geometry_notes.h"
#include "swath/quicklook.h"

#define TRIALS_MAX 20000 /* scenes, at about 1 ms each */

/* A plan, and the scene that is read for the trial. */
struct trial {
    struct image_plan plan;
    struct scene scene;
};

/* Reads a trial, for trial_clear, also on failure. are_relations: see campaign_read_scene. */
static sonject_status trial_read(struct trial *trial, struct sonject_campaign *campaign,
                                 uint32_t swath, uint32_t category, uint32_t item, uint32_t step,
                                 uint32_t attempt, bool *are_relations)
{
    scene_init(&trial->scene);
    trial->scene.mesh_store = &campaign->meshes;
    CHECK(image_plan_try(campaign->report, &campaign->campaign, swath, category, item, step,
                         attempt, &trial->plan));
    return campaign_read_scene(campaign, &trial->plan, &trial->scene, are_relations);
}

static void trial_clear(struct trial *trial)
{
    scene_clear(&trial->scene);
    image_plan_clear(&trial->plan);
}

/* Measures an opened swath with the sonar's altitude at each row. */
static sonject_status measure_rows(struct sonject_campaign *campaign, uint32_t number,
                                   const struct scene *scene, const struct swath_file *file)
{
    const struct swath_plan *swath = &campaign->campaign.swaths[number];
    const size_t rows = (size_t)swath->layout.rows;
    /* the condition of check_water_column */
    const bool may_show_water = scene->water_layer_count == 0 && scene->relief.count == 0;
    sonject_geometry_params geometry = scene->geometry;
    struct noted_geometry noted;
    geometry_notes_read(file, &noted);
    const bool tells = geometry_notes_to_params(&noted, &geometry);
    if (tells && !scene->has_files_geometry) {
        tell_other_geometry(campaign->report, swath->path, &geometry, &scene->geometry);
        geometry = scene->geometry; /* else that of all rows, as the file's picture has */
    }
    tell_grey_levels(campaign->report, swath->path, noted.grey_db, &scene->transfer);
    double *altitudes = allocate_array(rows, sizeof *altitudes);
    CHECK_MEMORY(campaign->report, altitudes, "the altitudes");
    row_altitudes(scene, swath_file_recording(file), &(struct region){.rows = rows}, altitudes);
    const sonject_status status = campaign_measure(campaign->report, &campaign->campaign, number,
                                                   &geometry, altitudes, may_show_water);
    free(altitudes);
    return status;
}

/* Returns the side that is taken of a picture of both sides; 0 without a nadir column. */
static uint32_t side_of_nadir(const sonject_geometry_params *geometry)
{
    if (!(geometry->nadir_column > 0.0))
        return 0;
    return geometry->side == SONJECT_SIDE_PORT ? RECORDED_PORT : RECORDED_STARBOARD;
}

const char *swath_side_word(const struct swath_plan *swath)
{
    static const char *const words[] = {
        "", [RECORDED_PORT] = "port", [RECORDED_STARBOARD] = "starboard"};
    return words[swath->side];
}

/* Finds size and room of a swath. The swath's scene gives the geometry. */
static sonject_status measure_swath(struct sonject_campaign *campaign, uint32_t number)
{
    struct swath_plan *swath = &campaign->campaign.swaths[number];
    struct trial trial;
    struct swath_file *file = NULL;
    sonject_status status =
        file_identify(campaign->report, swath->path, &campaign->swath_facts[number]);
    THEN(status, file_hash(campaign->report, swath->path, campaign->swath_hashes[number]));
    if (status == SONJECT_ERROR_MEMORY)
        return status;
    if (status != SONJECT_OK)
        return tree_failure(&campaign->campaign.tree, swath->place, "swaths",
                            "there is no %s that can be read; check its name", swath->path);
    status = trial_read(&trial, campaign, number, CATEGORY_EMPTY, 0, 0, 0, NULL);
    file_protect(campaign->report, swath->path);
    THEN(status, swath_file_open_array(campaign->report, swath->path, trial.scene.channel,
                                       trial.scene.array, &file));
    if (status == SONJECT_OK) {
        const struct recording *recording = swath_file_recording(file);
        swath->side = recording ? recording->side : side_of_nadir(&trial.scene.geometry);
        swath_file_layout(file, &swath->layout);
        if (campaign->campaign.format == FORMAT_AS_INPUT)
            swath->jpeg_quality = swath_file_jpeg_quality(file);
        status = measure_rows(campaign, number, &trial.scene, file);
        tell_calibration_doubts(campaign->report, &trial.scene, campaign->swath_hashes[number]);
    }
    if (status == SONJECT_OK)
        report_log(campaign->report,
                   "%s%s%s: altitudes and avoid leave %.4g %% of the places for images",
                   swath->written, swath->side ? ", " : "", swath_side_word(swath),
                   100.0 * crop_places_left(&swath->room));
    swath_file_close(&file);
    trial_clear(&trial);
    return status;
}

sonject_status campaign_draw_swath(struct sonject_campaign *campaign, uint32_t number,
                                   const char *picture)
{
    const struct swath_plan *swath = &campaign->campaign.swaths[number];
    const sonject_quicklook_params params = {.image = swath->path, .picture = picture};
    struct trial trial;
    struct region *boxes = allocate_array(swath->avoid_count, sizeof *boxes);
    CHECK_MEMORY(campaign->report, boxes, "the boxes to avoid");
    for (size_t i = 0; i < swath->avoid_count; i++)
        boxes[i] = swath->avoid[i].pixels;
    sonject_status status = trial_read(&trial, campaign, number, CATEGORY_EMPTY, 0, 0, 0, NULL);
    const struct image_options options = {trial.scene.channel, trial.scene.array,
                                          trial.scene.transfer, !trial.scene.has_files_geometry,
                                          trial.scene.geometry};
    THEN(status, draw_quicklook(campaign->report, &params, &options, boxes, swath->avoid_count));
    trial_clear(&trial);
    free(boxes);
    return status == SONJECT_ERROR_INPUT ? SONJECT_OK : status;
}

static sonject_status try_scene(struct sonject_campaign *campaign, struct hash *hash,
                                uint32_t swath, uint32_t category, uint32_t item, uint32_t step,
                                uint32_t attempt, bool *are_relations)
{
    struct trial trial;
    char text[HASH_TEXT_CAPACITY];
    sonject_status status =
        trial_read(&trial, campaign, swath, category, item, step, attempt, are_relations);
    THEN(status, scene_hash(campaign->report, &trial.scene, NULL, text));
    if (status == SONJECT_OK)
        hash_add_text(hash, text);
    trial_clear(&trial);
    return status;
}

/* Tries a step. If the ends do not fit each other, values between the ends are tried. *is_made: set
 * if a scene could be made. */
static sonject_status try_step(struct sonject_campaign *campaign, struct hash *hash,
                               uint32_t category, uint32_t item, uint32_t step, bool *is_made)
{
    sonject_status status = SONJECT_ERROR_INPUT;
    bool are_relations = true;
    for (uint32_t attempt = 0;
         status == SONJECT_ERROR_INPUT && are_relations && attempt < ATTEMPTS_MAX; attempt++) {
        are_relations = false;
        status = try_scene(campaign, hash, 0, category, item, step, attempt, &are_relations);
    }
    *is_made = *is_made || status == SONJECT_OK;
    return status == SONJECT_ERROR_INPUT && are_relations ? SONJECT_OK : status;
}

/* Tries each step of an item's draws, or of the scene's alone. *trials: grows by the steps. */
static sonject_status try_steps(struct sonject_campaign *campaign, struct hash *hash,
                                uint32_t category, uint32_t number, const struct item *item,
                                uint64_t *trials)
{
    const uint32_t steps = image_plan_steps(&campaign->campaign, item);
    bool is_made = false;
    *trials += steps;
    if (*trials > TRIALS_MAX)
        return report_failure(campaign->report, SONJECT_ERROR_INPUT,
                              "%s: has so many combinations of choices that more than %d scenes "
                              "would have to be checked; split it into several campaigns",
                              campaign->campaign.path, TRIALS_MAX);
    for (uint32_t step = 0; step < steps; step++)
        CHECK(try_step(campaign, hash, category, number, step, &is_made));
    if (is_made)
        return SONJECT_OK;
    /* fails again, with the message that says why */
    return try_scene(campaign, hash, 0, category, number, 0, 0, NULL);
}

/* Tries each swath, and each object with the ends and all choices of its draws. The files that
 * objects name are read, so that the hash covers the content of all that may be drawn. */
static sonject_status try_scenes(struct sonject_campaign *campaign, struct hash *hash)
{
    const struct campaign *plan = &campaign->campaign;
    uint64_t trials = 0;
    for (uint32_t i = 0; i < plan->swath_count; i++)
        CHECK(try_scene(campaign, hash, i, CATEGORY_EMPTY, 0, 1, 0, NULL));
    CHECK(try_steps(campaign, hash, CATEGORY_EMPTY, 0, NULL, &trials));
    for (uint32_t i = 0; i < plan->target_count; i++)
        CHECK(try_steps(campaign, hash, CATEGORY_TARGET + i, 0, &plan->targets[i], &trials));
    for (uint32_t i = 0; i < plan->clutter_count; i++)
        CHECK(try_steps(campaign, hash, CATEGORY_CLUTTER, i, &plan->clutter[i], &trials));
    return SONJECT_OK;
}

/* Adds a key of the campaign's file to the inputs, as a number or as a digest of its text. */
static void add_key(struct sonject_campaign *campaign, struct hash *hash,
                    const struct tree_entry *entry)
{
    struct growing_text text = {NULL, 0, 0, false};
    char digest[HASH_TEXT_CAPACITY];
    uint64_t count;
    tree_write_flow(&entry->value, &text);
    char *value = growing_text_end(&text);
    hash_add_text(hash, value);
    hash_restart(hash, digest);
    json_add(&campaign->inputs, entry->key,
             !value                         ? NULL
             : text_to_count(value, &count) ? json_seed(count)
                                            : json_string(digest));
    free(value);
}

static void add_tables(struct sonject_campaign *campaign, const char *list,
                       const struct item *items, uint32_t count)
{
    char name[64];
    for (uint32_t i = 0; i < count; i++)
        for (size_t k = 0; k < items[i].draws.count; k++) {
            const struct body_table *table = items[i].draws.list[k].table;
            snprintf(name, sizeof name, "the table of %s[%u]", list, (unsigned)i);
            if (table)
                json_add(&campaign->inputs, name, json_string(table->hash));
        }
}

static sonject_status make_inputs(struct sonject_campaign *campaign, struct hash *hash,
                                  const char *code, const char *trials)
{
    const struct campaign *plan = &campaign->campaign;
    const struct tree_node *root = &plan->tree.root;
    char digest[HASH_TEXT_CAPACITY];
    char name[48];
    campaign->inputs = JSON_OBJECT({"sonject", json_string(sonject_version())},
                                   {"sonject's kernels", json_string(code)});
    for (size_t i = 0; i < root->count; i++)
        add_key(campaign, hash, &root->entries[i]);
    hash_add(hash, campaign->scene_text, campaign->scene_bytes);
    hash_restart(hash, digest);
    json_add(&campaign->inputs, "the scene's file", json_string(digest));
    for (size_t i = 0; i < plan->swath_count; i++) {
        snprintf(name, sizeof name, "the file of swaths[%lu]", (unsigned long)i);
        json_add(&campaign->inputs, name, json_string(campaign->swath_hashes[i]));
    }
    add_tables(campaign, "targets", plan->targets, plan->target_count);
    add_tables(campaign, "clutter.objects", plan->clutter, plan->clutter_count);
    json_add(&campaign->inputs, "files that scene or targets name", json_string(trials));
    return json_document_hash(campaign->report, campaign->inputs, JSON_COMPACT | JSON_SORT_KEYS,
                              campaign->hash);
}

/* Opens and measures the swaths, splits them, tries scenes with all that may be drawn, and makes
 * the campaign's hash. */
static sonject_status check_all(struct sonject_campaign *campaign)
{
    struct campaign *plan = &campaign->campaign;
    char code[HASH_TEXT_CAPACITY];
    char trials[HASH_TEXT_CAPACITY];
    CHECK(code_hash(campaign->report, code));
    for (uint32_t i = 0; i < plan->swath_count; i++)
        CHECK(measure_swath(campaign, i));
    CHECK(campaign_split(campaign->report, plan, campaign->swath_hashes));
    CHECK(image_plan_check_grid(plan));
    struct hash *hash = hash_begin();
    CHECK_MEMORY(campaign->report, hash, "a hash");
    sonject_status status = try_scenes(campaign, hash);
    hash_restart(hash, trials);
    THEN(status, make_inputs(campaign, hash, code, trials));
    hash_end(hash, trials);
    return status;
}

static sonject_status check_file(struct report *report, const char *path,
                                 const struct path_facts *facts)
{
    return file_is_unchanged(path, facts)
               ? SONJECT_OK
               : input_failure(report, path,
                               "was changed since the campaign was read: read it again (start "
                               "anew)");
}

sonject_status campaign_check_unchanged(const struct sonject_campaign *campaign, uint32_t swath)
{
    const struct read_files *reads = &campaign->reads;
    for (size_t i = 0; i < reads->count; i++)
        CHECK(check_file(campaign->report, reads->files[i].path, &reads->files[i].facts));
    return check_file(campaign->report, campaign->campaign.swaths[swath].path,
                      &campaign->swath_facts[swath]);
}

sonject_status campaign_check_id(const struct sonject_campaign *campaign, uint64_t id)
{
    if (id < campaign->campaign.images)
        return SONJECT_OK;
    return report_failure(campaign->report, SONJECT_ERROR_ARGUMENT,
                          "there is no image %llu: the campaign has %llu, counted from 0",
                          (unsigned long long)id, (unsigned long long)campaign->campaign.images);
}

static sonject_status take_classes(struct sonject_campaign *campaign)
{
    const struct campaign *plan = &campaign->campaign;
    uint32_t number;
    const size_t clutter = plan->clutter_labelled ? plan->clutter_count : 0;
    for (size_t i = 0; i < plan->target_count + clutter; i++) {
        const struct item *item =
            i < plan->target_count ? &plan->targets[i] : &plan->clutter[i - plan->target_count];
        CHECK(class_names_take(&campaign->classes, campaign->report, item->class_name, &number));
    }
    return SONJECT_OK;
}

static sonject_status fill(struct sonject_campaign *campaign, const struct campaign_source *source)
{
    struct campaign *plan = &campaign->campaign;
    CHECK(campaign_read(campaign->report, source->path, source->text, source->overrides,
                        source->override_count, plan));
    if (source->has_one_target) {
        plan->empty = plan->clutter_alone = 0.0;
        plan->has_one_target = true;
    }
    CHECK(scene_file_load(campaign->report, plan->scene_path, &campaign->scene_text,
                          &campaign->scene_bytes));
    CHECK(take_classes(campaign));
    campaign->swath_hashes = allocate_array(plan->swath_count, sizeof *campaign->swath_hashes);
    CHECK_MEMORY(campaign->report, campaign->swath_hashes, "the campaign");
    campaign->swath_facts = allocate_array(plan->swath_count, sizeof *campaign->swath_facts);
    CHECK_MEMORY(campaign->report, campaign->swath_facts, "the campaign");
    campaign->report->reads = &campaign->reads; /* file and tables of the campaign are kept */
    const sonject_status status = check_all(campaign);
    campaign->report->reads = NULL;
    return status;
}

sonject_status campaign_open(struct report *report, const struct campaign_source *source,
                             struct sonject_campaign **campaign)
{
    *campaign = allocate_array(1, sizeof **campaign);
    CHECK_MEMORY(report, *campaign, "a campaign");
    (*campaign)->report = report;
    const sonject_status status = fill(*campaign, source);
    if (status != SONJECT_OK)
        campaign_close(campaign);
    return status;
}

void campaign_close(struct sonject_campaign **campaign)
{
    if (!*campaign)
        return;
    campaign_forget_calibrations(*campaign); /* uses swath_count, which is reset next */
    campaign_clear(&(*campaign)->campaign);
    swath_store_close(&(*campaign)->store);
    mesh_store_clear(&(*campaign)->meshes);
    class_names_clear(&(*campaign)->classes);
    json_decref((*campaign)->inputs);
    free((*campaign)->scene_text);
    free((*campaign)->swath_hashes);
    free((*campaign)->swath_facts);
    read_files_clear(&(*campaign)->reads);
    free(*campaign);
    *campaign = NULL;
}
