/* The loop over a campaign's images. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "base/report.h"
#include "base/system/process.h"
#include "dataset/data_set.h"

/* A run over images, and its progress. */
struct sweep {
    struct device_slot *slot;
    struct sonject_campaign *campaign;
    const sonject_campaign_run_params *params;
    sonject_progress_function progress;
    void *user;
    uint64_t made;  /* images of this run; atomic */
    double begin_s; /* time of the call; start_s: of the first image */
    double start_s;
    struct data_set set; /* data set in the folder */
    uint32_t *missing;   /* ids of images that were missing when the call began; owned */
    uint64_t missing_count;
};

/* Tells progress, also within images, so that the run can be cancelled there. */
static int tell_images(void *user, double done, const char *stage)
{
    struct sweep *sweep = user;
    const double elapsed = clock_seconds() - sweep->start_s;
    const double made = (double)__atomic_load_n(&sweep->made, __ATOMIC_RELAXED);
    char rate[32];
    if (!sweep->progress)
        return 0;
    const double images_per_s = elapsed > 0.0 ? made / elapsed : 0.0;
    if (images_per_s > 0.0)
        snprintf(rate, sizeof rate, "%.*f images/s", images_per_s < 10.0 ? 2 : 0, images_per_s);
    return sweep->progress(sweep->user, done / (double)sweep->missing_count,
                           images_per_s > 0.0 ? rate : stage);
}

/* Makes a missing image, unless another process has made it meanwhile. */
static sonject_status make_missing(void *user, const struct image_maker *maker, uint64_t index)
{
    struct sweep *sweep = user;
    struct report *report = maker->campaign->report;
    struct data_set set = sweep->set;
    struct campaign_image image;
    bool has = false;
    const uint64_t id = sweep->missing[index];
    const double limit_s = sweep->params->exit_after_s;
    if (limit_s > 0.0 && __atomic_load_n(&sweep->made, __ATOMIC_RELAXED) > 0 &&
        clock_seconds() - sweep->begin_s >= limit_s)
        return report_failure(report, SONJECT_CANCELLED, "stopped after %g s", limit_s);
    set.report = report;
    if (!sweep->params->only_one)
        CHECK(
            data_set_has_image(&set, image_split(&maker->campaign->campaign, id), id, NULL, &has));
    if (has)
        return SONJECT_OK;
    memset(&image, 0, sizeof image);
    sonject_status status = campaign_image_make(maker->device, maker->campaign, id, maker->progress,
                                                maker->user, &image);
    THEN(status, campaign_image_write(maker->campaign, &image, sweep->params->folder));
    campaign_image_clear(&image);
    __atomic_fetch_add(&sweep->made, status == SONJECT_OK, __ATOMIC_RELAXED);
    return status;
}

/* Returns the first id of this run. The shard's ids come in rising order. */
static uint64_t first_id(const sonject_campaign_run_params *params)
{
    return params->only_one ? params->only : params->shard_index - 1;
}

static uint64_t next_id(const struct sweep *sweep, uint64_t id)
{
    return sweep->params->only_one ? sweep->campaign->campaign.images
                                   : id + sweep->params->shard_count;
}

/* Finds the images that are not there, or not as they were written. */
static sonject_status find_missing(struct sweep *sweep)
{
    const struct campaign *plan = &sweep->campaign->campaign;
    sonject_status status = SONJECT_OK;
    sweep->missing = allocate_array(plan->images, sizeof *sweep->missing);
    CHECK_MEMORY(sweep->campaign->report, sweep->missing, "the images");
    for (uint64_t id = first_id(sweep->params); status == SONJECT_OK && id < plan->images;
         id = next_id(sweep, id)) {
        bool has = false;
        if (!sweep->params->only_one)
            status = data_set_has_image(&sweep->set, image_split(plan, id), id, NULL, &has);
        if (!has)
            sweep->missing[sweep->missing_count++] = (uint32_t)id;
    }
    return status;
}

/* Writes the times to a file of their own, since only times differ from run to run. */
static sonject_status write_times(const struct sweep *sweep)
{
    const double elapsed = clock_seconds() - sweep->start_s;
    char path[PATH_CAPACITY];
    CHECK(path_in(sweep->campaign->report, path, sweep->params->folder, "times.json"));
    json_t *document = JSON_OBJECT(
        {"images_made", json_count(sweep->made)}, {"seconds", json_number(elapsed)},
        {"images_per_second", json_number(elapsed > 0.0 ? (double)sweep->made / elapsed : 0.0)});
    return json_document_write(sweep->campaign->report, SONJECT_OK, document, 9, path);
}

/* Writes the documents of the whole. *is_finished: they were there before. */
static sonject_status finish_whole(struct sweep *sweep, bool *is_finished)
{
    sweep->set.progress = sweep->progress;
    sweep->set.user = sweep->user;
    *is_finished = false;
    if (sweep->missing_count == 0)
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
    sonject_status status =
        data_set_begin(&sweep.set, campaign, params->folder, params->overwrites != 0);
    campaign->folder = params->folder;
    THEN(status, find_missing(&sweep));
    sweep.start_s = clock_seconds();
    const struct image_work work = {sweep.missing_count, make_missing, tell_images, &sweep};
    THEN(status, campaign_work(campaign, slot, &work));
    if (status == SONJECT_OK && sweep.made > 0)
        status = write_times(&sweep);
    bool is_finished = sweep.missing_count == 0;
    if (status == SONJECT_OK && params->shard_count == 1 && !params->only_one)
        status = finish_whole(&sweep, &is_finished);
    campaign->folder = NULL;
    campaign_forget_calibrations(campaign);
    if (was_finished)
        *was_finished = status == SONJECT_OK && is_finished;
    data_set_clear(&sweep.set);
    free(sweep.missing);
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
