/* One image of a campaign: its scene, drawn and calibrated, and the injection into its swath. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "dataset/data_set.h"
#include "dataset/run.h"
#include "image/raster.h"
#include "schema/scene_file.h"

void campaign_image_clear(struct campaign_image *image)
{
    injection_result_clear(&image->result);
    swath_close(&image->swath);
    scene_clear(&image->scene);
    image_plan_clear(&image->plan);
}

/* Refuses an image whose files were changed meanwhile, which may also be why it failed. Puts the
 * image's number before the message of a failure. */
static sonject_status end_image(struct sonject_campaign *campaign,
                                const struct campaign_image *image, uint64_t id,
                                sonject_status status)
{
    struct report *report = campaign->report;
    char message[REPORT_CAPACITY];
    if ((status == SONJECT_OK || status == SONJECT_ERROR_INPUT) &&
        campaign_check_unchanged(campaign, image->plan.swath) != SONJECT_OK)
        status = SONJECT_ERROR_INPUT;
    if (status == SONJECT_OK || status == SONJECT_CANCELLED)
        return status;
    memcpy(message, report->message, sizeof message);
    return report_failure(report, status, "image %llu: %s", (unsigned long long)id, message);
}

/* Reports "--set KEY: what" where the campaign's file or table gave the key; false: neither did. */
static bool place_line(struct tree *tree, const struct image_plan *plan, const char *line)
{
    static const char start[] = "--set ";
    if (strncmp(line, start, strlen(start)) != 0)
        return false;
    line += strlen(start);
    for (size_t i = plan->key_count; i-- > 0;) { /* an object's draws come behind the object */
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
        const char *what = key_end ? key_end + 2 : line; /* the user wrote no --set */
        if (!place_line(tree, plan, line))
            mistakes_add(&mistakes, tree, &behind, what, what);
    }
    tree->mistakes = NULL;
    mistakes_tell(&mistakes, campaign->report, SONJECT_ERROR_INPUT);
}

char *input_override(const char *image)
{
    struct growing_text input = {NULL, 0, 0, false};
    growing_text_add(&input, "input.path=");
    tree_write_text(image, &input);
    return growing_text_end(&input);
}

sonject_status campaign_read_base(struct sonject_campaign *campaign, const char *image,
                                  struct scene_source *source, struct scene *scene)
{
    char *text = input_override(image);
    CHECK_MEMORY(campaign->report, text, "an image's scene");
    source->overrides[source->override_count++] = text;
    source->path = campaign->campaign.scene_path;
    source->text = campaign->scene_text;
    source->moved_folder = campaign->campaign.folder;
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
    const struct swath_plan *swath = &campaign->campaign.swaths[plan->swath];
    sonject_status status = campaign_read_base(campaign, swath->path, &source, scene);
    if (status != SONJECT_OK)
        place_message(campaign, plan);
    free(source.overrides);
    if (status == SONJECT_OK && !isnan(campaign->campaign.grey_db[0]) &&
        scene->transfer.kind == SONJECT_TRANSFER_DECIBEL) {
        scene_clear(scene);
        status = input_failure(campaign->report, campaign->campaign.path,
                               "grey: the numbers of %s are dB already (input.transfer): leave "
                               "grey out",
                               swath->written);
    }
    return status;
}

/* Keeps the first line of the first reason, and clears the message, since the call goes on. */
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

/* Refuses scenes of images in memory that ask for a calibration, which only a folder can keep. */
static sonject_status check_calibrated(const struct sonject_campaign *campaign,
                                       const struct campaign_image *image)
{
    if (!image->scene.calibrates_itself)
        return SONJECT_OK;
    return scene_locate(
        &image->scene, campaign->report,
        report_failure(
            campaign->report, SONJECT_ERROR_INPUT,
            "auto works only in campaigns with a folder: make one image with sonject campaign "
            "--only %llu -o FOLDER, and name the file FOLDER/" CALIBRATIONS_FOLDER
            "/%u.yaml that it writes, instead of auto",
            (unsigned long long)image->plan.id, (unsigned)image->plan.swath),
        "input.calibration");
}

/* Injects the drawn scene. *is_drawn: true where the drawn values make the injection fail. */
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

static const char *visibility_text(double decibels, char text[16])
{
    if (isnan(decibels))
        return "none";
    snprintf(text, 16, "%.1f dB", decibels);
    text_use_points(text);
    return text;
}

/* Finds the targets that are less visible than the campaign asks; false: none. next: of several
 * targets, only the faint ones are drawn again, and all other objects keep their places. */
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
        char highlight[16], shadow[16];
        snprintf(why, REASON_CAPACITY, "the target is seen too little: highlight %s, shadow %s",
                 visibility_text(truth->highlight_visibility_db, highlight),
                 visibility_text(truth->shadow_visibility_db, shadow));
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
    uint32_t redrawn = 0; /* draws of single targets */
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
            return end_image(campaign, image, id, status);
        }
        redrawn += next.of_all == attempts.of_all;
        attempts = next;
        keep_reason(campaign->report, status == SONJECT_OK ? too_faint : campaign->report->message,
                    reason);
        campaign_image_clear(image);
        memset(image, 0, sizeof *image);
    }
}

sonject_status campaign_image_round(struct report *report, struct campaign_image *image)
{
    const struct swath *swath = &image->swath;
    struct injection_result *result = &image->result;
    size_t bad = 0;
    uint64_t at_full_scale = 0; /* pixels of the input at full scale are counted already */
    if (swath->is_complex)
        return SONJECT_OK;
    void *stored = swath_stored_result(swath, result, &result->statistics.output_clipped);
    CHECK_MEMORY(report, stored, "an image");
    const sonject_status status =
        transfer_to_amplitude(&swath->transfer, swath->layout.type, stored,
                              result->rows * result->columns, result->image, &bad, &at_full_scale);
    free(stored);
    return status == SONJECT_OK
               ? SONJECT_OK
               : report_failure(
                     report, status,
                     "the number that the file would store at pixel %zu is not an amplitude", bad);
}
