/* The calls that tell of one image of a campaign, or make it in memory. */
#include <stdlib.h>
#include <string.h>

#include "api/campaign_handle.h"
#include "base/memory.h"

sonject_status sonject_campaign_image_count(const sonject_campaign *campaign, uint64_t *count)
{
    if (!campaign || !count)
        return SONJECT_ERROR_ARGUMENT;
    *count = campaign->campaign.images;
    return SONJECT_OK;
}

sonject_status campaign_check_id(const struct sonject_campaign *campaign, uint64_t id)
{
    if (id < campaign->campaign.images)
        return SONJECT_OK;
    return report_failure(campaign->report, SONJECT_ERROR_ARGUMENT,
                          "there is no image %llu: the campaign has %llu, counted from 0",
                          (unsigned long long)id, (unsigned long long)campaign->campaign.images);
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
    struct image_plan plan;
    sonject_campaign_image told;
    if (!campaign)
        return SONJECT_ERROR_ARGUMENT;
    CHECK(campaign_check_id(campaign, id));
    sonject_status status = image_plan_make(campaign->report, &campaign->campaign, id, &plan);
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
    if (!context || !scene)
        return SONJECT_ERROR_ARGUMENT;
    *scene = NULL;
    context_begin_call(context);
    if (!campaign)
        return null_argument(&context->report, "campaign");
    sonject_status status = campaign_check_id(campaign, id);
    THEN(status, sonject_scene_create(context, scene));
    if (status != SONJECT_OK)
        return status;
    status = image_plan_make(campaign->report, &campaign->campaign, id, &plan);
    THEN(status, campaign_read_scene(campaign, &plan, &(*scene)->scene));
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
    if (!campaign)
        return null_argument(&context->report, "campaign");
    CHECK(campaign_check_id(campaign, id));
    struct sonject_result *made = allocate_array(1, sizeof *made);
    CHECK_MEMORY(&context->report, made, "a result");
    memset(&image, 0, sizeof image);
    sonject_status status = campaign_image_make(context, campaign, id, progress, user, &image);
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
