/* Threads that make a campaign's images in parallel. Each has a queue on the device, and a copy of
 * the campaign with a message and stores of its own. The caller's thread makes no image: it reports
 * progress and log lines, since callbacks belong to that thread. */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/system/process.h"
#include "dataset/campaign.h"
#include "swath/decoder.h"

#define THREADS_MAX    16
#define PIXELS_AT_ONCE (UINT64_C(1) << 24) /* pixels of all images that are made at once */

/* The state that all threads share. lock guards all that changes. */
struct image_pool {
    struct sonject_campaign *campaign;
    const struct image_work *work;
    pthread_mutex_t lock, calibrating;
    pthread_cond_t changed; /* signals has_news */
    uint64_t next, done;    /* numbers of images begun, and done */
    size_t running;         /* number of threads */
    bool has_news;          /* there is something to tell, or a thread has ended */
    bool is_cancelled;
    char stage[64];        /* last stage of any image */
    sonject_status status; /* status of the first image that failed */
    uint64_t failed;       /* index of that image */
    struct growing_text lines;
};

struct image_thread {
    struct image_pool *pool;
    pthread_t thread;
    struct image_maker maker;
    struct sonject_campaign campaign;
    struct report report;
    struct report_host host; /* host.fraction, of the image, is guarded by the pool's lock */
    struct decoder decoder;
    struct device_slot slot;
    struct growing_text lines; /* log lines of its image */
};

/* Wakes the caller's thread. The lock must be held. */
static void tell_news(struct image_pool *pool)
{
    pool->has_news = true;
    pthread_cond_signal(&pool->changed);
}

/* Keeps a log line, with the level before it. */
static void keep_line(void *user, uint32_t level, const char *line)
{
    struct image_thread *thread = user;
    growing_text_add(&thread->lines, "%u%s\n", (unsigned)level, line);
}

/* Notes progress; not 0 cancels. While waiting for a process, called with the last fraction. */
static int note_fraction(void *user, double fraction, const char *stage)
{
    struct image_thread *thread = user;
    struct image_pool *pool = thread->pool;
    pthread_mutex_lock(&pool->lock);
    thread->host.fraction = fraction;
    if (*stage) /* otherwise the last stage still holds */
        snprintf(pool->stage, sizeof pool->stage, "%s", stage);
    const bool is_it = pool->is_cancelled;
    tell_news(pool);
    pthread_mutex_unlock(&pool->lock);
    return is_it;
}

/* Finds the next image for a thread; false: none. Images are begun in rising order, and those under
 * way when one fails are finished, so the first to fail is the same in every run. */
static bool begin_image(struct image_thread *thread, uint64_t *index)
{
    struct image_pool *pool = thread->pool;
    pthread_mutex_lock(&pool->lock);
    const bool is_one =
        pool->status == SONJECT_OK && !pool->is_cancelled && pool->next < pool->work->count;
    *index = pool->next;
    pool->next += is_one;
    pthread_mutex_unlock(&pool->lock);
    return is_one;
}

static void end_image(struct image_thread *thread, uint64_t index, sonject_status status)
{
    struct image_pool *pool = thread->pool;
    pthread_mutex_lock(&pool->lock);
    if (thread->lines.length > 0)
        growing_text_add(&pool->lines, "%s", thread->lines.characters);
    thread->lines.length = 0;
    thread->host.fraction = 0.0;
    pool->done += status == SONJECT_OK;
    if (status != SONJECT_OK && (pool->status == SONJECT_OK || index < pool->failed)) {
        pool->status = status;
        pool->failed = index;
        memcpy(pool->campaign->report->message, thread->report.message,
               sizeof thread->report.message);
    }
    tell_news(pool);
    pthread_mutex_unlock(&pool->lock);
}

static void *make_images(void *user)
{
    struct image_thread *thread = user;
    struct image_pool *pool = thread->pool;
    uint64_t index;
    while (begin_image(thread, &index)) {
        sonject_status status =
            device_slot_open(&thread->report, &thread->slot, &thread->maker.device);
        THEN(status, pool->work->make(pool->work->user, &thread->maker, index));
        end_image(thread, index, status);
    }
    pthread_mutex_lock(&pool->lock);
    pool->running--;
    tell_news(pool);
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

/* Returns the number of threads: two for each processor, since an image waits for device and disk
 * half of its time. Large images keep all processors busy by themselves, and take memory. */
static size_t thread_count(const struct sonject_campaign *campaign, uint64_t images)
{
    uint64_t largest = 1, count = 2 * (uint64_t)processor_count();
    for (size_t i = 0; i < campaign->campaign.swath_count; i++) {
        const struct swath_plan *swath = &campaign->campaign.swaths[i];
        const uint64_t pixels = swath->chip_rows * swath->chip_columns;
        largest = pixels > largest ? pixels : largest;
    }
    count = count < THREADS_MAX ? count : THREADS_MAX;
    count = count < images ? count : images;
    const uint64_t fitting = PIXELS_AT_ONCE / largest;
    return (size_t)(count <= fitting ? count : fitting > 1 ? fitting : 1);
}

/* Starts a thread; false: the system has none. */
static bool start_thread(struct image_thread *thread, struct image_pool *pool,
                         const struct device_slot *slot)
{
    const struct report *report = pool->campaign->report;
    thread->pool = pool;
    thread->campaign = *pool->campaign;
    thread->campaign.report = thread->campaign.campaign.tree.report = &thread->report;
    thread->campaign.calibrating = &pool->calibrating;
    thread->campaign.calibrations = NULL;
    memset(&thread->campaign.store, 0, sizeof thread->campaign.store);
    memset(&thread->campaign.meshes, 0, sizeof thread->campaign.meshes);
    thread->decoder.is_in_process =
        report->host && report->host->decoder && report->host->decoder->is_in_process;
    thread->host = (struct report_host){.log_user = thread,
                                        .decoder = &thread->decoder,
                                        .progress = note_fraction,
                                        .progress_user = thread};
    thread->report.log = report->log ? keep_line : NULL;
    thread->report.host = &thread->host;
    thread->slot.params = slot->params;
    thread->maker = (struct image_maker){NULL, &thread->campaign, note_fraction, thread};
    pthread_mutex_lock(&pool->lock);
    const bool is_started = thread_start(&thread->thread, make_images, thread);
    pool->running += is_started;
    pthread_mutex_unlock(&pool->lock);
    return is_started;
}

static void end_thread(struct image_thread *thread)
{
    pthread_join(thread->thread, NULL);
    campaign_forget_calibrations(&thread->campaign);
    swath_store_close(&thread->campaign.store);
    mesh_store_clear(&thread->campaign.meshes);
    decoder_stop(&thread->decoder);
    device_slot_close(&thread->slot);
    free(thread->lines.characters);
}

static void tell_lines(struct report *report, char *lines)
{
    for (char *line = lines, *end; (end = strchr(line, '\n')) != NULL; line = end + 1) {
        *end = '\0';
        report_line(report, (uint32_t)(*line - '0'), line + 1);
    }
}

/* Reports progress and log lines until all threads have ended. Callbacks are called without the
 * lock, so that no thread waits for them. */
static void watch(struct image_pool *pool, const struct image_thread *threads, size_t count)
{
    pthread_mutex_lock(&pool->lock);
    for (bool is_end = false; !is_end;) {
        is_end = pool->running == 0;
        pool->has_news = false;
        struct growing_text lines = pool->lines;
        memset(&pool->lines, 0, sizeof pool->lines);
        double done = (double)pool->done;
        char stage[sizeof pool->stage];
        memcpy(stage, pool->stage, sizeof stage);
        for (size_t i = 0; i < count; i++)
            done += threads[i].host.fraction;
        pthread_mutex_unlock(&pool->lock);
        if (lines.length > 0)
            tell_lines(pool->campaign->report, lines.characters);
        free(lines.characters);
        const bool is_to_end =
            pool->work->tell && pool->work->tell(pool->work->user, done, stage) != 0;
        pthread_mutex_lock(&pool->lock);
        pool->is_cancelled = pool->is_cancelled || is_to_end;
        while (!is_end && !pool->has_news)
            pthread_cond_wait(&pool->changed, &pool->lock);
    }
    pthread_mutex_unlock(&pool->lock);
}

sonject_status campaign_work(struct sonject_campaign *campaign, const struct device_slot *slot,
                             const struct image_work *work)
{
    struct image_pool pool = {.campaign = campaign, .work = work, .stage = "first image"};
    const size_t count = thread_count(campaign, work->count);
    if (work->count == 0)
        return SONJECT_OK;
    struct image_thread *threads = allocate_array(count + 1, sizeof *threads);
    CHECK_MEMORY(campaign->report, threads, "the campaign's images");
    pthread_mutex_init(&pool.lock, NULL);
    pthread_mutex_init(&pool.calibrating, NULL);
    pthread_cond_init(&pool.changed, NULL);
    size_t started = 0;
    while (started < count && start_thread(&threads[started], &pool, slot))
        started++;
    watch(&pool, threads, started);
    for (size_t i = 0; i < started; i++)
        end_thread(&threads[i]);
    pthread_cond_destroy(&pool.changed);
    pthread_mutex_destroy(&pool.calibrating);
    pthread_mutex_destroy(&pool.lock);
    free(threads);
    if (started == 0)
        return report_failure(campaign->report, SONJECT_ERROR_MEMORY,
                              "the system starts no thread for the campaign's images");
    if (pool.status == SONJECT_OK && pool.is_cancelled)
        return report_failure(campaign->report, SONJECT_CANCELLED, "cancelled");
    return pool.status;
}
