#include "api/campaign_handle.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "api/scene_hash.h"
#include "base/file.h"
#include "base/memory.h"
#include "cl/sources.h"
#include "io/scene_file.h"
#include "io/yaml_flow.h"

#define HASH_STEP  ((size_t)1 << 20)
#define TRIALS_MAX 1000 /* of a campaign, about a second */

sonject_status code_hash(struct report *report, char text[HASH_TEXT_CAPACITY])
{
    struct hash *hash = hash_begin();
    if (!hash)
        return report_out_of_memory(report, "a hash");
    hash_add_text(hash, sonject_version());
    for (size_t i = 0; i < PROGRAM_COUNT; i++)
        hash_add(hash, embedded_sources[i].text, embedded_sources[i].bytes);
    hash_end(hash, text);
    return SONJECT_OK;
}

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

/* What the scene reader says of "--set KEY: ..." is the campaign file's where that drew the key. */
static void place_message(struct sonject_campaign *campaign, const struct image_plan *plan)
{
    static const char start[] = "--set ";
    char message[REPORT_CAPACITY];
    memcpy(message, campaign->report->message, sizeof message);
    if (strncmp(message, start, strlen(start)) != 0)
        return;
    const char *key = message + strlen(start);
    for (size_t i = 0; i < plan->key_count; i++) {
        const char *text = plan->keys[i].text;
        const size_t length = strcspn(text, "=");
        const char *rest = key + length;
        if (plan->keys[i].place.line == 0 || strncmp(key, text, length) != 0 ||
            (*rest != ':' && *rest != '.' && *rest != '['))
            continue;
        tree_failure(&campaign->campaign.tree, plan->keys[i].place, "", "%s", key);
        return;
    }
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
        const struct scene_text source = {campaign->campaign.scene_path,
                                          campaign->scene_text,
                                          campaign->scene_bytes,
                                          overrides,
                                          plan->key_count + 1,
                                          campaign->campaign.folder,
                                          plan->key_count,
                                          campaign->allows_user_shapes};
        status = scene_text_read(campaign->report, &source, scene);
        if (status != SONJECT_OK)
            place_message(campaign, plan);
    }
    free(overrides);
    free(input_text);
    return status;
}

/* Size and room of a swath, whose scene tells its geometry. */
static sonject_status measure_swath(struct sonject_campaign *campaign, uint32_t number)
{
    struct swath_plan *swath = &campaign->campaign.swaths[number];
    struct image_plan plan;
    struct scene scene;
    struct swath_file *file = NULL;
    scene_init(&scene);
    sonject_status status =
        hash_file(campaign->report, swath->path, campaign->swath_hashes[number]);
    if (status != SONJECT_OK)
        return tree_failure(&campaign->campaign.tree, swath->place, "swaths",
                            "there is no %s that "
                            "can be read; check its name",
                            swath->path);
    status =
        image_plan_try(campaign->report, &campaign->campaign, number, CATEGORY_EMPTY, 0, 0, &plan);
    if (status == SONJECT_OK)
        status = campaign_read_scene(campaign, &plan, &scene);
    if (status == SONJECT_OK)
        status = swath_file_open(campaign->report, swath->path, scene.channel, &file);
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
    sonject_status status =
        image_plan_try(campaign->report, &campaign->campaign, swath, category, item, step, &plan);
    if (status == SONJECT_OK)
        status = campaign_read_scene(campaign, &plan, &scene);
    if (status == SONJECT_OK)
        status = place_free_hash(campaign->report, &scene, NULL, text);
    if (status == SONJECT_OK)
        hash_add_text(hash, text);
    scene_clear(&scene);
    image_plan_clear(&plan);
    return status;
}

/* Tries each object with the ends of what is drawn, and each swath. Files that objects name are
 * read, so their content is in the hash. */
static sonject_status try_scenes(struct sonject_campaign *campaign, struct hash *hash)
{
    const struct campaign *plan = &campaign->campaign;
    const uint32_t kinds = (uint32_t)(CATEGORY_TARGET + plan->target_count);
    uint32_t trials = 0;
    sonject_status status = SONJECT_OK;
    for (uint32_t i = 0; status == SONJECT_OK && i < plan->swath_count; i++)
        status = try_scene(campaign, hash, i, CATEGORY_EMPTY, 0, 1);
    for (uint32_t step = 0; step < image_plan_steps(plan) && trials < TRIALS_MAX; step++) {
        for (uint32_t i = CATEGORY_TARGET; status == SONJECT_OK && i < kinds; i++, trials++)
            status = try_scene(campaign, hash, 0, i, 0, step);
        for (uint32_t i = 0; status == SONJECT_OK && i < plan->clutter_count; i++, trials++)
            status = try_scene(campaign, hash, 0, CATEGORY_CLUTTER, i, step);
    }
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

static sonject_status check_campaign(struct sonject_campaign *campaign)
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

static sonject_status open_campaign(struct sonject_campaign *campaign, const char *path,
                                    const char *const *overrides, size_t count)
{
    struct campaign *plan = &campaign->campaign;
    sonject_status status = campaign_read(campaign->report, path, overrides, count, plan);
    if (status == SONJECT_OK)
        status = scene_file_load(campaign->report, plan->scene_path, &campaign->scene_text,
                                 &campaign->scene_bytes);
    if (status != SONJECT_OK)
        return status;
    campaign->swath_hashes = allocate_array(plan->swath_count, sizeof *campaign->swath_hashes);
    if (!campaign->swath_hashes)
        return report_out_of_memory(campaign->report, "the campaign");
    return check_campaign(campaign);
}

void sonject_campaign_read_params_init(sonject_campaign_read_params *params)
{
    memset(params, 0, sizeof *params);
    params->struct_size = sizeof *params;
}

sonject_status sonject_campaign_read(sonject_context *context, const char *path,
                                     const char *const *overrides, size_t count,
                                     const sonject_campaign_read_params *params,
                                     sonject_campaign **campaign)
{
    if (!context || !campaign)
        return SONJECT_ERROR_ARGUMENT;
    *campaign = NULL;
    context_begin_call(context);
    sonject_campaign_read_params taken;
    sonject_campaign_read_params_init(&taken);
    sonject_status status = SONJECT_OK;
    if (params)
        status = params_take(&context->report, &taken, sizeof taken, params, sizeof taken,
                             "campaign read parameters");
    if (status != SONJECT_OK)
        return status;
    if (!path || (count > 0 && !overrides))
        return null_argument(&context->report, "path and overrides");
    for (size_t i = 0; i < count; i++)
        if (!overrides[i])
            return null_argument(&context->report, "an override");
    struct sonject_campaign *made = allocate_array(1, sizeof *made);
    if (!made)
        return report_out_of_memory(&context->report, "a campaign");
    made->report = &context->report;
    made->allows_user_shapes = taken.allows_user_shapes != 0;
    status = open_campaign(made, path, overrides, count);
    if (status != SONJECT_OK)
        sonject_campaign_release(&made);
    *campaign = made;
    return status;
}

void sonject_campaign_release(sonject_campaign **campaign)
{
    if (!campaign || !*campaign)
        return;
    campaign_clear(&(*campaign)->campaign);
    swath_store_close(&(*campaign)->store);
    free((*campaign)->scene_text);
    free((*campaign)->swath_hashes);
    free(*campaign);
    *campaign = NULL;
}
