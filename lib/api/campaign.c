/* Campaigns of the public interface: read, described, made image by image. */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "api/handles.h"
#include "base/memory.h"
#include "dataset/campaign.h"
#include "dataset/fit.h"
#include "schema/scene_file.h"
#include "schema/yaml_tree.h"

/* Takes a campaign's file and overrides, which stay the caller's. */
static sonject_status take_source(struct report *report, const char *path,
                                  const sonject_scene_read_params *params,
                                  struct campaign_source *source)
{
    sonject_scene_read_params taken;
    CHECK(scene_read_params_take(report, path, params, &taken));
    *source = (struct campaign_source){
        .path = path, .overrides = taken.overrides, .override_count = taken.override_count};
    return taken.text
               ? report_failure(report, SONJECT_ERROR_ARGUMENT, "a campaign is read from its file")
               : SONJECT_OK;
}

sonject_status sonject_campaign_read(sonject_context *context, const char *path,
                                     const sonject_scene_read_params *params,
                                     sonject_campaign **campaign)
{
    struct campaign_source source;
    BEGIN_MAKING(context, campaign);
    CHECK(take_source(&context->report, path, params, &source));
    return campaign_open(&context->report, &source, campaign);
}

void sonject_campaign_release(sonject_campaign **campaign)
{
    if (campaign)
        campaign_close(campaign);
}

sonject_status sonject_campaign_image_count(const sonject_campaign *campaign, uint64_t *count)
{
    if (!campaign)
        return SONJECT_ERROR_ARGUMENT;
    if (!count)
        return null_argument(campaign->report, "count");
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
    BEGIN_MAKING(context, scene);
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
    THEN(status, campaign_check_unchanged(campaign, plan.swath));
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
    BEGIN_MAKING(context, result);
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
    THEN(status, campaign_image_round(&context->report, &image));
    if (status == SONJECT_OK) {
        made->report = &context->report;
        made->result = image.result;
        memset(&image.result, 0, sizeof image.result);
        *result = made;
    } else {
        free(made);
    }
    campaign_image_clear(&image);
    return context_finish(context, status);
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
        return report_failure(
            campaign->report, SONJECT_ERROR_ARGUMENT,
            "shards cannot overwrite another campaign, since they would remove each other's "
            "images: first make image 0 alone (--only 0 --overwrite)");
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
    return context_finish(
        context, campaign_run(campaign, &context->device, &taken, progress, user, was_finished));
}

sonject_status sonject_campaign_merge(sonject_context *context, const char *folder,
                                      sonject_progress_function progress, void *user)
{
    CHECK(context_begin_call(context));
    context_watch(context, &progress, &user);
    if (!folder || !folder[0])
        return null_argument(&context->report, "folder");
    return context_finish(context, campaign_merge(&context->report, folder, progress, user));
}

sonject_status sonject_campaign_fit(sonject_context *context, const char *path,
                                    const sonject_scene_read_params *params,
                                    const sonject_campaign_fit_params *fit_params,
                                    sonject_progress_function progress, void *user)
{
    struct campaign_source source;
    sonject_campaign_fit_params fit;
    CHECK(context_begin_call(context));
    context_watch(context, &progress, &user);
    struct report *report = &context->report;
    CHECK(take_source(report, path, params, &source));
    CHECK(params_take(report, &fit, sizeof fit, fit_params, sizeof fit, "fit parameters"));
    if (!fit.contacts || !fit.contacts[0])
        return null_argument(report, "contacts");
    if (!fit.fitted || !fit.fitted[0])
        return null_argument(report, "fitted");
    if (fit.part > SONJECT_LABELS_SHADOW)
        return report_failure(report, SONJECT_ERROR_ARGUMENT, "part must be 0 to 2, not %u",
                              (unsigned)fit.part);
    for (size_t i = 0; i < fit.class_count; i++)
        if (!fit.classes || !fit.classes[i])
            return null_argument(report, "classes");
    return context_finish(context,
                          campaign_fit(report, &context->device, &source, &fit, progress, user));
}
