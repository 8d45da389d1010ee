/* The loop over a campaign's images. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "base/report.h"
#include "dataset/data_set.h"

/* A run over images, and how far it is. */
struct sweep {
    struct device_slot *slot;
    struct sonject_campaign *campaign;
    const sonject_campaign_run_params *params;
    sonject_progress_function progress;
    void *user;
    double start_s;
    uint64_t made, missing; /* images of this run */
    double begin_s;         /* of the call; start_s: of the first image */
    struct data_set set;    /* the folder's */
    uint8_t *is_missing;    /* of each image whether it was when the call began; owned */
};

/* Within an image, so that it can be cancelled there. */
static int tell_image(void *user, double fraction, const char *stage)
{
    const struct sweep *sweep = user;
    char rate[32] = "first image";
    const double elapsed = clock_seconds() - sweep->start_s;
    (void)stage;
    if (!sweep->progress)
        return 0;
    const double images_per_s = elapsed > 0.0 ? (double)sweep->made / elapsed : 0.0;
    if (images_per_s > 0.0)
        snprintf(rate, sizeof rate, "%.*f images/s", images_per_s < 10.0 ? 2 : 0, images_per_s);
    return sweep->progress(sweep->user, ((double)sweep->made + fraction) / (double)sweep->missing,
                           rate);
}

static sonject_status make_image(struct sweep *sweep, uint64_t id)
{
    struct campaign_image image;
    struct device *device;
    memset(&image, 0, sizeof image);
    sonject_status status = device_slot_open(sweep->campaign->report, sweep->slot, &device);
    THEN(status, campaign_image_make(device, sweep->campaign, id, tell_image, sweep, &image));
    THEN(status, campaign_image_write(sweep->campaign, &image, sweep->params->folder));
    campaign_image_clear(&image);
    sweep->made++;
    if (status == SONJECT_OK && tell_image(sweep, 0.0, "") != 0)
        status = report_failure(sweep->campaign->report, SONJECT_CANCELLED, "cancelled");
    const double limit_s = sweep->params->exit_after_s;
    if (status == SONJECT_OK && limit_s > 0.0 && sweep->made < sweep->missing &&
        clock_seconds() - sweep->begin_s >= limit_s)
        status = report_failure(sweep->campaign->report, SONJECT_CANCELLED, "stopped after %g s",
                                limit_s);
    return status;
}

/* Ids of this run: the shard's, in rising order. */
static uint64_t first_id(const sonject_campaign_run_params *params)
{
    return params->only_one ? params->only : params->shard_index - 1;
}

static uint64_t next_id(const struct sweep *sweep, uint64_t id)
{
    return sweep->params->only_one ? sweep->campaign->campaign.images
                                   : id + sweep->params->shard_count;
}

/* Images that are not there, or not as they were written. */
static sonject_status find_missing(struct sweep *sweep)
{
    const struct campaign *plan = &sweep->campaign->campaign;
    sonject_status status = SONJECT_OK;
    sweep->is_missing = allocate_array(plan->images, 1);
    CHECK_MEMORY(sweep->campaign->report, sweep->is_missing, "the images");
    for (uint64_t id = first_id(sweep->params); status == SONJECT_OK && id < plan->images;
         id = next_id(sweep, id)) {
        bool has = false;
        if (!sweep->params->only_one)
            status = data_set_has_image(&sweep->set, image_split(plan, id), id, NULL, &has);
        sweep->is_missing[id] = !has;
        sweep->missing += !has;
    }
    return status;
}

/* Another process may be at the same campaign: what it made meanwhile is not made again. */
static sonject_status make_missing(struct sweep *sweep)
{
    const struct campaign *plan = &sweep->campaign->campaign;
    sonject_status status = SONJECT_OK;
    for (uint64_t id = first_id(sweep->params); status == SONJECT_OK && id < plan->images;
         id = next_id(sweep, id)) {
        bool has = !sweep->is_missing[id];
        if (!has && !sweep->params->only_one)
            status = data_set_has_image(&sweep->set, image_split(plan, id), id, NULL, &has);
        if (status == SONJECT_OK && !has)
            status = make_image(sweep, id);
    }
    return status;
}

/* Images whose shapes are code depend on the device. */
static sonject_status begin_set(struct sweep *sweep)
{
    struct device *device = NULL;
    if (sweep->campaign->has_user_shapes)
        CHECK(device_slot_open(sweep->campaign->report, sweep->slot, &device));
    return data_set_begin(&sweep->set, sweep->campaign, device, sweep->params->folder,
                          sweep->params->overwrites != 0);
}

/* Times are the only thing that differs from run to run, and so in a file of their own. */
static sonject_status write_times(const struct sweep *sweep)
{
    const double elapsed = clock_seconds() - sweep->start_s;
    char path[PATH_CAPACITY];
    CHECK(path_in(sweep->campaign->report, path, sweep->params->folder, "times.json"));
    json_t *document = JSON_OBJECT(
        {"images_made", json_count(sweep->made)}, {"seconds", json_number(elapsed)},
        {"images_per_second", json_number(elapsed > 0.0 ? (double)sweep->made / elapsed : 0.0)});
    return json_document_write(sweep->campaign->report, document, 9, path);
}

/* The documents of the whole; *is_finished: they were there. */
static sonject_status finish_whole(struct sweep *sweep, bool *is_finished)
{
    sweep->set.progress = sweep->progress;
    sweep->set.user = sweep->user;
    *is_finished = false;
    if (sweep->missing == 0)
        CHECK(data_set_is_finished(&sweep->set, is_finished));
    return *is_finished ? SONJECT_OK : data_set_finish(&sweep->set);
}

sonject_status campaign_run(struct sonject_campaign *campaign, struct device_slot *slot,
                            const sonject_campaign_run_params *params,
                            sonject_progress_function progress, void *user, int *was_finished)
{
    struct sweep sweep = {.slot = slot,
                          .campaign = campaign,
                          .params = params,
                          .progress = progress,
                          .user = user,
                          .begin_s = clock_seconds()};
    sonject_status status = begin_set(&sweep);
    campaign->folder = params->folder;
    THEN(status, find_missing(&sweep));
    sweep.start_s = clock_seconds();
    THEN(status, make_missing(&sweep));
    if (status == SONJECT_OK && sweep.made > 0)
        status = write_times(&sweep);
    bool is_finished = sweep.missing == 0;
    if (status == SONJECT_OK && params->shard_count == 1 && !params->only_one)
        status = finish_whole(&sweep, &is_finished);
    campaign->folder = NULL;
    campaign_forget_calibrations(campaign);
    if (was_finished)
        *was_finished = status == SONJECT_OK && is_finished;
    data_set_clear(&sweep.set);
    free(sweep.is_missing);
    return status;
}

sonject_status campaign_merge(struct report *report, const char *folder,
                              sonject_progress_function progress, void *user)
{
    struct data_set set;
    memset(&set, 0, sizeof set);
    sonject_status status = data_set_open(&set, report, folder);
    set.progress = progress;
    set.user = user;
    THEN(status, data_set_finish(&set));
    data_set_clear(&set);
    return status;
}
