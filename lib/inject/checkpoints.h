/* Tracing that is shared out among shards, and that can be stopped and continued. Its tallies lie
 * in the folder `work` of a run's folder. */
#ifndef SONJECT_INJECT_CHECKPOINTS_H
#define SONJECT_INJECT_CHECKPOINTS_H

#include <stdbool.h>

#include "inject/impulses.h"
#include "inject/injection.h"
#include "trace/sums_file.h"

#define SHARDS_MAX 9999

struct run_request {
    const struct scene *scene;
    const struct scene_source *source; /* the scene's; kept with what is traced */
    const struct sums_file *sums;      /* tallies of everything; NULL: they are traced */
    const struct scene *traced;        /* scene of the tallies: scene, or one of another response */
    uint32_t shard, shards;            /* shard: 1...shards; shards 0: all is traced */
    bool merges;                       /* nothing is traced, since all shards' tallies are there */
    double exit_after_s;               /* 0: never */
    double checkpoint_s;
    const char *folder;
    sonject_progress_function progress; /* may be NULL */
    void *user;
    uint32_t label_formats; /* sum of sonject_labels */
    bool overwrites;        /* another result in the folder may be lost */
};

struct checkpoint_job {
    struct report *report;
    struct device *device;
    const struct run_request *request;
    const char *scene_hash, *image_hash;
    const struct injection_input *input;
    double start_s; /* clock_seconds() at the beginning of the call */
    sonject_progress_function progress;
    void *user;
};

/* Forms the result of a run by rays: of the whole run, of all shards where the request merges, or
 * of the request's sums. For a request of one shard only its tallies are made, and *is_formed is
 * false. Earlier tallies are not traced again, and stay until checkpoints_remove. Errors: as
 * sonject_run and sonject_merge. */
sonject_status inject_by_checkpoints(const struct checkpoint_job *job,
                                     struct injection_result *result, bool *is_formed);

/* Traces everything into a file of sums. Errors: as sonject_trace. */
sonject_status trace_into_file(const struct checkpoint_job *job, const char *path);

/* Returns the folder of a run's tallies, for free(); NULL where memory is out. */
char *checkpoints_folder(const char *folder);

/* Reports that the file at path was traced by something else. Returns INPUT. */
sonject_status refuse_foreign_sums(struct report *report, const char *path, const char *what);

/* Removes the tallies of a run whose results are written. */
void checkpoints_remove(const char *folder);

#endif
