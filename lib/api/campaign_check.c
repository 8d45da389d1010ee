/* Whether all that a campaign may draw can be made, and the hash of what its images depend on. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "api/campaign_handle.h"
#include "api/scene_hash.h"
#include "base/memory.h"

#define HASH_STEP  ((size_t)1 << 20)
#define TRIALS_MAX 20000 /* scenes, about as many milliseconds at the most */

static sonject_status hash_file(struct report *report, const char *path,
                                char text[HASH_TEXT_CAPACITY])
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: cannot be read: %s", path,
                              strerror(errno));
    struct hash *hash = hash_begin();
    char *bytes = malloc(HASH_STEP);
    if (!hash || !bytes) {
        if (hash)
            hash_end(hash, text);
        free(bytes);
        fclose(file);
        return report_out_of_memory(report, "a hash");
    }
    size_t count;
    while ((count = fread(bytes, 1, HASH_STEP, file)) > 0)
        hash_add(hash, bytes, count);
    const bool failed = ferror(file) != 0;
    hash_end(hash, text);
    free(bytes);
    fclose(file);
    return failed ? report_failure(report, SONJECT_ERROR_STORAGE, "%s: cannot be read to its end",
                                   path)
                  : SONJECT_OK;
}

sonject_status place_free_hash(struct report *report, const struct scene *scene,
                               const char *input_identity, char text[HASH_TEXT_CAPACITY])
{
    struct scene nameless = *scene;
    nameless.input_path = NULL;
    return scene_hash(report, &nameless, input_identity, text);
}

/* Size and room of a swath, whose scene tells its geometry. */
static sonject_status measure_swath(struct sonject_campaign *campaign, uint32_t number)
{
    struct swath_plan *swath = &campaign->campaign.swaths[number];
    struct image_plan plan;
    struct scene scene;
    struct swath_file *file = NULL;
    scene_init(&scene);
    scene.mesh_store = &campaign->meshes;
    sonject_status status =
        hash_file(campaign->report, swath->path, campaign->swath_hashes[number]);
    if (status == SONJECT_ERROR_MEMORY)
        return status;
    if (status != SONJECT_OK)
        return tree_failure(&campaign->campaign.tree, swath->place, "swaths",
                            "there is no %s that can be read; check its name", swath->path);
    status =
        image_plan_try(campaign->report, &campaign->campaign, number, CATEGORY_EMPTY, 0, 0, &plan);
    if (status == SONJECT_OK)
        status = campaign_read_scene(campaign, &plan, &scene);
    if (status == SONJECT_OK)
        status =
            swath_file_open_array(campaign->report, swath->path, scene.channel, scene.array, &file);
    if (status == SONJECT_OK) {
        swath_file_layout(file, &swath->layout);
        status = campaign_measure(campaign->report, &campaign->campaign, number, &scene.geometry);
    }
    swath_file_close(&file);
    scene_clear(&scene);
    image_plan_clear(&plan);
    return status;
}

static sonject_status try_scene(struct sonject_campaign *campaign, struct hash *hash,
                                uint32_t swath, uint32_t category, uint32_t item, uint32_t step)
{
    struct image_plan plan;
    struct scene scene;
    char text[HASH_TEXT_CAPACITY];
    scene_init(&scene);
    scene.mesh_store = &campaign->meshes;
    sonject_status status =
        image_plan_try(campaign->report, &campaign->campaign, swath, category, item, step, &plan);
    if (status == SONJECT_OK)
        status = campaign_read_scene(campaign, &plan, &scene);
    if (status == SONJECT_OK)
        status = place_free_hash(campaign->report, &scene, NULL, text);
    if (status == SONJECT_OK)
        hash_add_text(hash, text);
    campaign->has_user_shapes = campaign->has_user_shapes || scene.user_shapes.count > 0;
    scene_clear(&scene);
    image_plan_clear(&plan);
    return status;
}

/* Each step of what is drawn of an item, or of the scene alone. */
static sonject_status try_steps(struct sonject_campaign *campaign, struct hash *hash,
                                uint32_t category, uint32_t number, const struct item *item,
                                uint64_t *trials)
{
    const uint32_t steps = image_plan_steps(&campaign->campaign, item);
    sonject_status status = SONJECT_OK;
    *trials += steps;
    if (*trials > TRIALS_MAX)
        return report_failure(campaign->report, SONJECT_ERROR_INPUT,
                              "%s: draws from so many choices that more than %d scenes were to be "
                              "checked; make several campaigns of it",
                              campaign->campaign.path, TRIALS_MAX);
    for (uint32_t step = 0; status == SONJECT_OK && step < steps; step++)
        status = try_scene(campaign, hash, 0, category, number, step);
    return status;
}

/* Tries each swath, and each object with the ends and all choices of what is drawn of it. Files
 * that objects name are read, so that the content of all that may be drawn is in the hash. */
static sonject_status try_scenes(struct sonject_campaign *campaign, struct hash *hash)
{
    const struct campaign *plan = &campaign->campaign;
    uint64_t trials = 0;
    sonject_status status = SONJECT_OK;
    for (uint32_t i = 0; status == SONJECT_OK && i < plan->swath_count; i++)
        status = try_scene(campaign, hash, i, CATEGORY_EMPTY, 0, 1);
    if (status == SONJECT_OK)
        status = try_steps(campaign, hash, CATEGORY_EMPTY, 0, NULL, &trials);
    for (uint32_t i = 0; status == SONJECT_OK && i < plan->target_count; i++)
        status = try_steps(campaign, hash, CATEGORY_TARGET + i, 0, &plan->targets[i], &trials);
    for (uint32_t i = 0; status == SONJECT_OK && i < plan->clutter_count; i++)
        status = try_steps(campaign, hash, CATEGORY_CLUTTER, i, &plan->clutter[i], &trials);
    return status;
}

static sonject_status split_swaths(struct sonject_campaign *campaign)
{
    struct campaign *plan = &campaign->campaign;
    const char **identities = allocate_array(plan->swath_count, sizeof *identities);
    if (!identities)
        return report_out_of_memory(campaign->report, "the splits");
    for (size_t i = 0; i < plan->swath_count; i++)
        identities[i] = campaign->swath_hashes[i];
    const sonject_status status = campaign_split(campaign->report, plan, identities);
    free(identities);
    return status;
}

sonject_status campaign_check(struct sonject_campaign *campaign)
{
    struct campaign *plan = &campaign->campaign;
    char code[HASH_TEXT_CAPACITY];
    struct hash *hash = hash_begin();
    if (!hash)
        return report_out_of_memory(campaign->report, "a hash");
    sonject_status status = code_hash(campaign->report, code);
    for (uint32_t i = 0; status == SONJECT_OK && i < plan->swath_count; i++)
        status = measure_swath(campaign, i);
    if (status == SONJECT_OK)
        status = split_swaths(campaign);
    if (status == SONJECT_OK)
        status = image_plan_check_grid(plan);
    if (status == SONJECT_OK)
        status = try_scenes(campaign, hash);
    if (status == SONJECT_OK) {
        hash_add_text(hash, code);
        hash_add_text(hash, plan->canonical);
        hash_add(hash, campaign->scene_text, campaign->scene_bytes);
        for (size_t i = 0; i < plan->swath_count; i++)
            hash_add_text(hash, campaign->swath_hashes[i]);
    }
    hash_end(hash, campaign->hash);
    return status;
}
