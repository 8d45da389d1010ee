#include "trace/checkpoint.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"

/* The rays of a slice. Strips are traced slice by slice, so that a signal need not wait long. */
#define SLICE_RAYS   ((uint64_t)1 << 23)
#define SLICE_STRIPS 64 /* the fewest strips of a slice: enough for all cores */

static sonject_status begin(struct checkpoint *checkpoint, struct report *report)
{
    memset(checkpoint, 0, sizeof *checkpoint);
    checkpoint->report = report;
    checkpoint->launches = hash_begin();
    CHECK_MEMORY(report, checkpoint->launches, "a hash");
    return SONJECT_OK;
}

sonject_status checkpoint_begin(struct checkpoint *checkpoint, struct report *report,
                                const char *path, const char *folder, const struct sums_head *head)
{
    sonject_status status = begin(checkpoint, report);
    THEN(status, sums_writer_begin(&checkpoint->writer, report, path, folder));
    checkpoint->head = *head;
    checkpoint->next = head->first;
    if (status != SONJECT_OK)
        checkpoint_clear(checkpoint);
    return status;
}

sonject_status checkpoint_begin_adding(struct checkpoint *checkpoint, struct report *report,
                                       const struct sums_file *const *files, size_t count)
{
    CHECK(begin(checkpoint, report));
    checkpoint->head.shard = checkpoint->head.shards = 1;
    checkpoint->files = files;
    checkpoint->file_count = count;
    checkpoint->is_stopping = true; /* nothing is traced */
    return SONJECT_OK;
}

void checkpoint_clear(struct checkpoint *checkpoint)
{
    char digest[HASH_TEXT_CAPACITY];
    if (checkpoint->launches)
        hash_end(checkpoint->launches, digest);
    sums_writer_clear(&checkpoint->writer);
    free(checkpoint->sums);
    memset(checkpoint, 0, sizeof *checkpoint);
}

void checkpoint_launch(struct checkpoint *checkpoint, const struct fan_record *fan,
                       const struct ray_table *rays)
{
    const uint64_t strips = (uint64_t)fan->strips;
    const uint64_t most = SLICE_RAYS / ((uint64_t)fan->rays * fan->strata + 1);
    checkpoint->turn = strips * (checkpoint->head.shard - 1) / checkpoint->head.shards;
    checkpoint->before = checkpoint->strips;
    checkpoint->strips +=
        strips * checkpoint->head.shard / checkpoint->head.shards - checkpoint->turn;
    checkpoint->slice = (int32_t)(most < SLICE_STRIPS ? SLICE_STRIPS : most);
    hash_add(checkpoint->launches, fan, sizeof *fan);
    if (rays->count > 0)
        hash_add(checkpoint->launches, rays->pieces, rays->count * sizeof *rays->pieces);
}

bool checkpoint_next(struct checkpoint *checkpoint, struct span *turns)
{
    if (checkpoint->is_stopping || checkpoint->next >= checkpoint->strips)
        return false;
    const uint64_t left = checkpoint->strips - checkpoint->next;
    turns->first = (int32_t)(checkpoint->turn + (checkpoint->next - checkpoint->before));
    turns->count = left < (uint64_t)checkpoint->slice ? (int32_t)left : checkpoint->slice;
    return true;
}

void checkpoint_advance(struct checkpoint *checkpoint, struct span turns)
{
    checkpoint->next += (uint64_t)turns.count;
    if (checkpoint->ask && checkpoint->ask(checkpoint->user))
        checkpoint->is_stopping = true;
}

bool checkpoint_is_cut_short(const struct checkpoint *checkpoint)
{
    return checkpoint && !checkpoint->files && checkpoint->is_stopping;
}

sonject_status checkpoint_add_up(struct checkpoint *checkpoint, uint64_t count,
                                 sums_run_function *take, void *user)
{
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < checkpoint->file_count; i++)
        status = sums_file_runs(checkpoint->files[i], checkpoint->report, checkpoint->record, count,
                                take, user);
    checkpoint->record++;
    return status;
}

bool add_without_overflow(int64_t *sum, int64_t value)
{
    if (value > 0 ? *sum > INT64_MAX - value : *sum < INT64_MIN - value)
        return false;
    *sum += value;
    return true;
}

static bool add_run(void *user, uint64_t first, const int64_t *values, size_t count)
{
    int64_t *sums = (int64_t *)user + first;
    for (size_t i = 0; i < count; i++)
        if (!add_without_overflow(&sums[i], values[i]))
            return false;
    return true;
}

sonject_status checkpoint_sums(struct checkpoint *checkpoint, const int64_t *traced, size_t count,
                               const int64_t **sums)
{
    *sums = traced;
    if (!checkpoint)
        return SONJECT_OK;
    if (!checkpoint->files)
        return sums_writer_add_all(&checkpoint->writer, traced, count);
    free(checkpoint->sums);
    checkpoint->sums = allocate_array(count, sizeof *checkpoint->sums);
    CHECK_MEMORY(checkpoint->report, checkpoint->sums, "tallies");
    *sums = checkpoint->sums;
    return checkpoint_add_up(checkpoint, count, add_run, checkpoint->sums);
}

sonject_status checkpoint_finish(struct checkpoint *checkpoint, struct trace_counts *counts)
{
    struct sums_head *head = &checkpoint->head;
    hash_end(checkpoint->launches, head->launches);
    checkpoint->launches = NULL;
    head->rays = counts->rays;
    head->queries = counts->queries;
    head->impulses = counts->impulses;
    /* A wish to stop that came with the last strips left all traced, but not all handed on. */
    if (!checkpoint->files)
        return checkpoint->next >= checkpoint->strips && !checkpoint->is_stopping
                   ? SONJECT_OK
                   : report_failure(checkpoint->report, SONJECT_CANCELLED,
                                    "cancelled while tracing");
    counts->rays = counts->queries = counts->impulses = 0;
    for (size_t i = 0; i < checkpoint->file_count; i++) {
        const struct sums_file *file = checkpoint->files[i];
        counts->rays += file->head.rays;
        counts->queries += file->head.queries;
        counts->impulses += file->head.impulses;
        if (strcmp(file->head.launches, head->launches) != 0 ||
            file->head.records != checkpoint->record)
            return input_failure(
                checkpoint->report, file->path,
                "was traced with other rays than this machine computes, whose mathematics may "
                "differ: trace, merge and form on machines of one kind");
    }
    return SONJECT_OK;
}

sonject_status checkpoint_publish(struct checkpoint *checkpoint, const struct scene_source *source)
{
    checkpoint->head.last = checkpoint->next;
    checkpoint->head.is_last = checkpoint->next >= checkpoint->strips;
    return sums_writer_publish(&checkpoint->writer, &checkpoint->head, source);
}
