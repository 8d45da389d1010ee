/* The division of tracing between processes, and in time. A shard is one process's share of every
 * launch. A strip's turn is its place in the order in which a launch takes strips. Shards get
 * ranges of turns, so that each has its part of the slow strips. A checkpoint is what one process
 * traces of a shard in one go. All processes go through the same launches in the same order. They
 * hand on integer sums: all checkpoints together have the sums of one process, bit by bit. */
#ifndef SONJECT_TRACE_CHECKPOINT_H
#define SONJECT_TRACE_CHECKPOINT_H

#include "kernels/layout.h"
#include "scene/patch_view.h"
#include "trace/fan.h"
#include "trace/sums_file.h"
#include "trace/tracer.h"

struct checkpoint {
    struct report *report;
    struct sums_head head; /* tells what is traced: shard, first and so on */
    uint64_t next;    /* number of the strip to trace next, in the shard's strips of all launches */
    bool is_stopping; /* nothing more is traced; later launches are only counted */
    int (*ask)(void *user); /* called after each slice of a launch; nonzero stops; may be NULL */
    void *user;
    struct sums_writer writer; /* holds what is traced; unused where checkpoints are added up */

    /* Checkpoints that are added up instead of tracing. */
    const struct sums_file *const *files; /* NULL: sums are traced */
    size_t file_count;

    /* Progress so far. */
    struct hash *launches; /* hash over all launches; owned; NULL once they are over */
    uint64_t strips;       /* the shard's strips in the launches so far */
    uint64_t before;       /* the shard's strips in the launches before this one */
    uint64_t turn;         /* the shard's first turn in this launch */
    int32_t slice;         /* strips of this launch that are traced at a time */
    uint64_t record;       /* number of the next block of sums */
    int64_t *sums;         /* added-up sums; owned */
};

/* Begins to trace a shard from head->first on; earlier strips are in other checkpoints. Borrows
 * report, path and folder (sums_writer_begin). After success the caller calls checkpoint_clear.
 * Errors: STORAGE, MEMORY. */
sonject_status checkpoint_begin(struct checkpoint *checkpoint, struct report *report,
                                const char *path, const char *folder, const struct sums_head *head);

/* Begins to add up checkpoints of one identity that together hold everything. Borrows files. */
sonject_status checkpoint_begin_adding(struct checkpoint *checkpoint, struct report *report,
                                       const struct sums_file *const *files, size_t count);
void checkpoint_clear(struct checkpoint *checkpoint);

/* Announces a launch of fan->strips strips. */
void checkpoint_launch(struct checkpoint *checkpoint, const struct fan_record *fan,
                       const struct ray_table *rays);

/* Finds the launch's next turns, which the caller traces and then gives to checkpoint_advance.
 * Returns false where none are left. */
bool checkpoint_next(struct checkpoint *checkpoint, struct span *turns);
void checkpoint_advance(struct checkpoint *checkpoint, struct span turns);

/* Returns whether less was traced than asked for: sums are useless then. False for NULL. */
bool checkpoint_is_cut_short(const struct checkpoint *checkpoint);

/* Hands traced sums to the checkpoint and sets *sums to the sums to go on with, valid until the
 * next call. Without a checkpoint (NULL) these are the traced ones. Errors: INPUT (damaged files),
 * STORAGE, MEMORY. */
sonject_status checkpoint_sums(struct checkpoint *checkpoint, const int64_t *traced, size_t count,
                               const int64_t **sums);

/* Adds up sums that are not one array: hands the runs of all files to `take`. Errors: as
 * checkpoint_sums. */
sonject_status checkpoint_add_up(struct checkpoint *checkpoint, uint64_t count,
                                 sums_run_function *take, void *user);

/* Adds a value to a sum. Returns false, with the sum unchanged, where the result does not fit. */
bool add_without_overflow(int64_t *sum, int64_t value);

/* Ends the launches: checks that everything was traced and handed on, or could be added up. counts
 * are this checkpoint's; where checkpoints are added up, counts become the sum over all. Errors:
 * INPUT (the checkpoints launched other things, or hold more sums), CANCELLED (tracing was stopped,
 * even with the last strips). */
sonject_status checkpoint_finish(struct checkpoint *checkpoint, struct trace_counts *counts);

/* Gives what was traced, all or not, its name in the folder, after checkpoint_finish. source may be
 * NULL. Errors: STORAGE, MEMORY. */
sonject_status checkpoint_publish(struct checkpoint *checkpoint, const struct scene_source *source);

#endif
