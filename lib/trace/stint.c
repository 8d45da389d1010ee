#include "trace/stint.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* Strips are traced some at a time, so that a signal does not wait for long. */
#define SLICE_RAYS   ((uint64_t)1 << 23)
#define SLICE_STRIPS 64 /* or at least so many: for all cores */

static sonject_status begin(struct stint *stint, struct report *report)
{
    memset(stint, 0, sizeof *stint);
    stint->report = report;
    stint->shard = stint->shards = 1;
    stint->course = hash_begin();
    return stint->course ? SONJECT_OK : report_out_of_memory(report, "a hash");
}

sonject_status stint_begin(struct stint *stint, struct report *report, const char *folder,
                           const struct stint_head *head, struct stint_source source,
                           uint64_t first)
{
    sonject_status status = begin(stint, report);
    if (status == SONJECT_OK)
        status = stint_writer_begin(&stint->writer, report, folder, head, source);
    if (status != SONJECT_OK) {
        stint_clear(stint);
        return status;
    }
    stint->shard = head->shard;
    stint->shards = head->shards;
    stint->first = stint->next = first;
    return SONJECT_OK;
}

sonject_status stint_begin_adding(struct stint *stint, struct report *report,
                                  const struct stint_file *const *files, size_t count)
{
    const sonject_status status = begin(stint, report);
    stint->files = files;
    stint->file_count = count;
    stint->is_stopping = true; /* nothing is traced */
    return status;
}

void stint_clear(struct stint *stint)
{
    char digest[HASH_TEXT_CAPACITY];
    if (stint->course)
        hash_end(stint->course, digest);
    stint_writer_clear(&stint->writer);
    free(stint->sums);
    memset(stint, 0, sizeof *stint);
}

void stint_launch(struct stint *stint, const struct fan_record *fan, const struct ray_table *rays)
{
    const uint64_t strips = (uint64_t)fan->strips;
    const uint64_t most = SLICE_RAYS / ((uint64_t)fan->rays * fan->strata + 1);
    stint->turn = strips * (stint->shard - 1) / stint->shards;
    stint->before = stint->strips;
    stint->strips += strips * stint->shard / stint->shards - stint->turn;
    stint->slice = (int32_t)(most < SLICE_STRIPS ? SLICE_STRIPS : most);
    hash_add(stint->course, fan, sizeof *fan);
    if (rays->count > 0)
        hash_add(stint->course, rays->pieces, rays->count * sizeof *rays->pieces);
}

bool stint_next(struct stint *stint, struct span *turns)
{
    if (stint->is_stopping || stint->next >= stint->strips)
        return false;
    const uint64_t left = stint->strips - stint->next;
    turns->first = (int32_t)(stint->turn + (stint->next - stint->before));
    turns->count = left < (uint64_t)stint->slice ? (int32_t)left : stint->slice;
    return true;
}

void stint_advance(struct stint *stint, struct span turns)
{
    stint->next += (uint64_t)turns.count;
    if (stint->ask && stint->ask(stint->user))
        stint->is_stopping = true;
}

bool stint_is_cut_short(const struct stint *stint)
{
    return stint && !stint->files && stint->is_stopping;
}

sonject_status stint_add_up(struct stint *stint, uint64_t count, stint_run_function *take,
                            void *user)
{
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < stint->file_count; i++)
        status = stint_file_runs(stint->files[i], stint->report, stint->record, count, take, user);
    stint->record++;
    return status;
}

bool add_without_overflow(int64_t *sum, int64_t value)
{
    if (value > 0 ? *sum > INT64_MAX - value : *sum < INT64_MIN - value)
        return false;
    *sum += value;
    return true;
}

struct sums {
    int64_t *values;
};

static bool add_run(void *user, uint64_t first, const int64_t *values, size_t count)
{
    int64_t *sums = ((struct sums *)user)->values + first;
    for (size_t i = 0; i < count; i++)
        if (!add_without_overflow(&sums[i], values[i]))
            return false;
    return true;
}

sonject_status stint_sums(struct stint *stint, const int64_t *traced, size_t count,
                          const int64_t **sums)
{
    *sums = traced;
    if (!stint)
        return SONJECT_OK;
    if (!stint->files)
        return stint_writer_sums(&stint->writer, traced, count);
    free(stint->sums);
    stint->sums = allocate_array(count, sizeof *stint->sums);
    if (!stint->sums)
        return report_out_of_memory(stint->report, "tallies");
    struct sums all = {stint->sums};
    *sums = stint->sums;
    return stint_add_up(stint, count, add_run, &all);
}

static void end_course(struct stint *stint)
{
    char digest[HASH_TEXT_CAPACITY];
    hash_end(stint->course, digest);
    stint->course = NULL;
    memcpy(stint->end.course, digest, sizeof digest);
}

static sonject_status compare_courses(const struct stint *stint)
{
    for (size_t i = 0; i < stint->file_count; i++) {
        const struct stint_file *file = stint->files[i];
        if (strcmp(file->end.course, stint->end.course) != 0 || file->end.records != stint->record)
            return report_failure(stint->report, SONJECT_ERROR_INPUT,
                                  "%s: traced other rays than this machine would, whose "
                                  "mathematics may differ: run all shards and merge on machines "
                                  "of one kind",
                                  file->path);
    }
    return SONJECT_OK;
}

sonject_status stint_finish(struct stint *stint, struct trace_counts *counts)
{
    end_course(stint);
    stint->end.rays = counts->rays;
    stint->end.queries = counts->queries;
    stint->end.impulses = counts->impulses;
    if (!stint->files)
        return stint->next >= stint->strips
                   ? SONJECT_OK
                   : report_failure(stint->report, SONJECT_CANCELLED, "cancelled while tracing");
    counts->rays = counts->queries = counts->impulses = 0;
    for (size_t i = 0; i < stint->file_count; i++) {
        counts->rays += stint->files[i]->end.rays;
        counts->queries += stint->files[i]->end.queries;
        counts->impulses += stint->files[i]->end.impulses;
    }
    return compare_courses(stint);
}

sonject_status stint_publish(struct stint *stint)
{
    stint->end.first = stint->first;
    stint->end.last = stint->next;
    stint->end.is_last = stint->next >= stint->strips;
    return stint_writer_publish(&stint->writer, &stint->end);
}
