/* How tracing is cut between processes, and in time. Every launch's strips are shared out among the
 * shards by their turns, so that each has its part of what takes long, and a checkpoint is what one
 * process traces of a shard in one go. All go through the same launches in the same order, whatever
 * they trace of them; what they hand on are integer sums, so those of all checkpoints add up to
 * what one process would have found, bit by bit. */
#ifndef SONJECT_TRACE_CHECKPOINT_H
#define SONJECT_TRACE_CHECKPOINT_H

#include "kernels/layout.h"
#include "scene/patch_view.h"
#include "trace/fan.h"
#include "trace/sums_file.h"
#include "trace/tracer.h"

struct checkpoint {
    struct report *report;
    struct sums_head head;  /* of what is traced: shard, first... */
    uint64_t next;          /* of the shard's strips, counted over all launches: to trace next */
    bool is_stopping;       /* nothing more is traced; the rest is only gone through */
    int (*ask)(void *user); /* after each slice of a launch: nonzero stops; NULL: never */
    void *user;
    struct sums_writer writer; /* what is traced; unused where checkpoints are added up */

    /* Added up instead of traced. */
    const struct sums_file *const *files; /* NULL: traced */
    size_t file_count;

    /* How far it went. */
    struct hash *launches; /* of all launches; owned; NULL once they are over */
    uint64_t strips;       /* of the shard, in the launches so far */
    uint64_t before;       /* of them, in the launches before this one */
    uint64_t turn;         /* the shard's first in this launch */
    int32_t slice;         /* strips of this launch that are traced at a time */
    uint64_t record;       /* number of the next sums */
    int64_t *sums;         /* added up; owned */
};

/* Begins to trace the shard of a head from head->first on: strips before it are in other
 * checkpoints. Borrows report, path and folder, which are sums_writer_begin's. On success to be
 * given to checkpoint_clear. Errors: MEMORY. */
sonject_status checkpoint_begin(struct checkpoint *checkpoint, struct report *report,
                                const char *path, const char *folder, const struct sums_head *head);

/* Begins to add up checkpoints, all of one identity, which together are everything. */
sonject_status checkpoint_begin_adding(struct checkpoint *checkpoint, struct report *report,
                                       const struct sums_file *const *files, size_t count);
void checkpoint_clear(struct checkpoint *checkpoint);

/* A launch comes, of fan->strips strips. */
void checkpoint_launch(struct checkpoint *checkpoint, const struct fan_record *fan,
                       const struct ray_table *rays);

/* The next turns of it to trace; false: no more. checkpoint_advance, once they are. */
bool checkpoint_next(struct checkpoint *checkpoint, struct span *turns);
void checkpoint_advance(struct checkpoint *checkpoint, struct span turns);

/* Whether less was traced than is asked for, so that sums are of no use. checkpoint may be NULL. */
bool checkpoint_is_cut_short(const struct checkpoint *checkpoint);

/* Sums are read: *sums are those to go on with, valid until the next call. checkpoint NULL: the
 * traced ones. Errors: INPUT (damaged files), STORAGE, MEMORY. */
sonject_status checkpoint_sums(struct checkpoint *checkpoint, const int64_t *traced, size_t count,
                               const int64_t **sums);

/* The same for sums that are not one array: those of all files are handed to `take`. */
sonject_status checkpoint_add_up(struct checkpoint *checkpoint, uint64_t count,
                                 sums_run_function *take, void *user);

/* Adds to a sum; false where it does not fit. */
bool add_without_overflow(int64_t *sum, int64_t value);

/* All launches are over: whether everything was traced, or could be added up. counts are this
 * checkpoint's; where checkpoints are added up they become those of all. Errors: INPUT (the
 * checkpoints launched other things, or hold more sums), CANCELLED (less was traced). */
sonject_status checkpoint_finish(struct checkpoint *checkpoint, struct trace_counts *counts);

/* Gives what was traced, up to the end or less, its name in the folder; after checkpoint_finish.
 * source may be NULL. Errors: STORAGE, MEMORY. */
sonject_status checkpoint_publish(struct checkpoint *checkpoint, const struct scene_source *source);

#endif
