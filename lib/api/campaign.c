/* Campaigns as the public interface has them: read, described, made image by image. */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "api/handles.h"
#include "base/memory.h"
#include "dataset/campaign.h"
#include "schema/scene_file.h"
#include "schema/yaml_tree.h"

static sonject_status take_classes(struct sonject_campaign *campaign)
{
    const struct campaign *plan = &campaign->campaign;
    uint32_t number;
    for (size_t i = 0; i < plan->target_count + plan->clutter_count; i++) {
        const struct item *item =
            i < plan->target_count ? &plan->targets[i] : &plan->clutter[i - plan->target_count];
        CHECK(class_names_take(&campaign->classes, campaign->report, item->class_name, &number));
    }
    return SONJECT_OK;
}

static sonject_status open_campaign(struct sonject_campaign *campaign, const char *path,
                                    const char *const *overrides, size_t count)
{
    struct campaign *plan = &campaign->campaign;
    CHECK(campaign_read(campaign->report, path, overrides, count, plan));
    CHECK(scene_file_load(campaign->report, plan->scene_path, &campaign->scene_text,
                          &campaign->scene_bytes));
    CHECK(take_classes(campaign));
    campaign->swath_hashes = allocate_array(plan->swath_count, sizeof *campaign->swath_hashes);
    CHECK_MEMORY(campaign->report, campaign->swath_hashes, "the campaign");
    return campaign_check(campaign);
}

sonject_status sonject_campaign_read(sonject_context *context, const char *path,
                                     const sonject_scene_read_params *params,
                                     sonject_campaign **campaign)
{
    sonject_scene_read_params taken;
    if (!context || !campaign)
        return SONJECT_ERROR_ARGUMENT;
    *campaign = NULL;
    context_begin_call(context);
    struct report *report = &context->report;
    CHECK(scene_read_params_take(report, path, params, &taken));
    if (taken.text)
        return report_failure(report, SONJECT_ERROR_ARGUMENT, "a campaign is read from its file");
    struct sonject_campaign *made = allocate_array(1, sizeof *made);
    CHECK_MEMORY(report, made, "a campaign");
    made->report = report;
    made->allows_user_shapes = taken.allows_user_shapes != 0;
    const sonject_status status = open_campaign(made, path, taken.overrides, taken.override_count);
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
    mesh_store_clear(&(*campaign)->meshes);
    class_names_clear(&(*campaign)->classes);
    json_decref((*campaign)->inputs);
    free((*campaign)->scene_text);
    free((*campaign)->swath_hashes);
    free(*campaign);
    *campaign = NULL;
}

sonject_status sonject_campaign_image_count(const sonject_campaign *campaign, uint64_t *count)
{
    if (!campaign || !count)
        return SONJECT_ERROR_ARGUMENT;
    *count = campaign->campaign.images;
    return SONJECT_OK;
}

static void describe_plan(const struct campaign *campaign, const struct image_plan *plan,
                          sonject_campaign_image *told)
{
    memset(told, 0, sizeof *told);
    told->id = plan->id;
    told->first_row = plan->chip.first_row;
    told->first_column = plan->chip.first_column;
    told->rows = plan->chip.rows;
    told->columns = plan->chip.columns;
    told->seed = plan->seed;
    told->swath = plan->swath;
    told->object_count = plan->object_count;
    told->has_target = plan->category >= CATEGORY_TARGET;
    strcpy(told->split, campaign->splits[plan->split].name);
    if (told->has_target)
        memcpy(told->class_name, campaign->targets[plan->category - CATEGORY_TARGET].class_name,
               sizeof told->class_name);
}

sonject_status sonject_campaign_describe(const sonject_campaign *campaign, uint64_t id,
                                         sonject_campaign_image *image)
{
    const struct attempts none = {0};
    struct image_plan plan;
    sonject_campaign_image told;
    if (!campaign)
        return SONJECT_ERROR_ARGUMENT;
    CHECK(campaign_check_id(campaign, id));
    sonject_status status =
        image_plan_make(campaign->report, &campaign->campaign, id, &none, &plan);
    if (status == SONJECT_OK) {
        describe_plan(&campaign->campaign, &plan, &told);
        status = params_give(campaign->report, image, &told, sizeof told, sizeof told,
                             "a campaign's image");
    }
    image_plan_clear(&plan);
    return status;
}

sonject_status sonject_campaign_scene(sonject_context *context, sonject_campaign *campaign,
                                      uint64_t id, sonject_scene **scene)
{
    struct image_plan plan;
    struct attempts attempts = {0};
    char reason[REASON_CAPACITY] = "";
    if (!context || !scene)
        return SONJECT_ERROR_ARGUMENT;
    *scene = NULL;
    context_begin_call(context);
    if (!campaign)
        return null_argument(&context->report, "campaign");
    sonject_status status = campaign_check_id(campaign, id);
    if (status == SONJECT_OK) {
        *scene = allocate_array(1, sizeof **scene);
        status = *scene ? SONJECT_OK : report_out_of_memory(&context->report, "a scene");
    }
    if (status != SONJECT_OK)
        return status;
    (*scene)->report = &context->report;
    (*scene)->is_read = true;
    scene_init(&(*scene)->scene);
    status = campaign_draw_scene(campaign, id, &attempts, reason, &plan, &(*scene)->scene);
    image_plan_clear(&plan);
    if (status != SONJECT_OK)
        sonject_scene_release(scene);
    return status;
}

sonject_status sonject_campaign_inject(sonject_context *context, sonject_campaign *campaign,
                                       uint64_t id, sonject_progress_function progress, void *user,
                                       sonject_result **result)
{
    struct campaign_image image;
    if (!context || !result)
        return SONJECT_ERROR_ARGUMENT;
    *result = NULL;
    context_begin_call(context);
    context_watch(context, &progress, &user);
    if (!campaign)
        return null_argument(&context->report, "campaign");
    struct device *device;
    CHECK(campaign_check_id(campaign, id));
    CHECK(device_slot_open(&context->report, &context->device, &device));
    struct sonject_result *made = allocate_array(1, sizeof *made);
    CHECK_MEMORY(&context->report, made, "a result");
    memset(&image, 0, sizeof image);
    sonject_status status = campaign_image_make(device, campaign, id, progress, user, &image);
    if (status == SONJECT_OK) {
        made->report = &context->report;
        made->result = image.result;
        memset(&image.result, 0, sizeof image.result);
        *result = made;
    } else {
        free(made);
    }
    campaign_image_clear(&image);
    return status;
}

static sonject_status check_run_params(const struct sonject_campaign *campaign,
                                       sonject_campaign_run_params *params)
{
    if (!params->folder || !params->folder[0])
        return null_argument(campaign->report, "folder");
    if (params->shard_count == 0 && params->shard_index == 0)
        params->shard_index = params->shard_count = 1;
    if (params->shard_index == 0 || params->shard_index > params->shard_count)
        return report_failure(campaign->report, SONJECT_ERROR_ARGUMENT,
                              "shard_index must be from 1 to shard_count, %u",
                              (unsigned)params->shard_count);
    if (params->overwrites && params->shard_count > 1)
        return report_failure(campaign->report, SONJECT_ERROR_ARGUMENT,
                              "shards overwrite no other campaign, since they would remove each "
                              "other's images: make image 0 alone so first (--only 0 --overwrite)");
    if (!(params->exit_after_s >= 0.0) || !isfinite(params->exit_after_s))
        return report_failure(campaign->report, SONJECT_ERROR_ARGUMENT,
                              "times are seconds, not below 0");
    return params->only_one ? campaign_check_id(campaign, params->only) : SONJECT_OK;
}

sonject_status sonject_campaign_run(sonject_context *context, sonject_campaign *campaign,
                                    const sonject_campaign_run_params *params,
                                    sonject_progress_function progress, void *user,
                                    int *was_finished)
{
    CHECK(context_begin_call(context));
    context_watch(context, &progress, &user);
    if (!campaign)
        return null_argument(&context->report, "campaign");
    sonject_campaign_run_params taken;
    CHECK(params_take(&context->report, &taken, sizeof taken, params,
                      offsetof(sonject_campaign_run_params, exit_after_s),
                      "campaign run parameters"));
    CHECK(check_run_params(campaign, &taken));
    return campaign_run(campaign, &context->device, &taken, progress, user, was_finished);
}

sonject_status sonject_campaign_merge(sonject_context *context, const char *folder,
                                      sonject_progress_function progress, void *user)
{
    CHECK(context_begin_call(context));
    context_watch(context, &progress, &user);
    if (!folder || !folder[0])
        return null_argument(&context->report, "folder");
    return campaign_merge(&context->report, folder, progress, user);
}
