/* Tracing that is shared out, and that can be stopped and gone on with: tallies in a run's folder
 * work. */
#ifndef SONJECT_INJECT_CHECKPOINTS_H
#define SONJECT_INJECT_CHECKPOINTS_H

#include <stdbool.h>

#include "inject/impulses.h"
#include "inject/injection.h"
#include "trace/sums_file.h"

#define SHARDS_MAX 9999

struct run_request {
    const struct scene *scene;
    const struct scene_source *source; /* of the scene; kept with what is traced */
    const struct sums_file *sums;      /* of everything, instead of tracing; NULL: it is traced */
    const struct scene *traced;        /* what they are of: scene, or one of another response */
    uint32_t shard, shards;            /* 1...shards; shards 0: all is traced */
    bool merges;                       /* nothing is traced: all shards' tallies are there */
    double exit_after_s;               /* 0: never */
    double checkpoint_s;
    const char *folder;
    sonject_progress_function progress; /* may be NULL */
    void *user;
    uint32_t label_formats; /* sum of sonject_labels */
    bool overwrites;        /* another result in the folder may be given up */
};

struct checkpoint_job {
    struct report *report;
    struct device *device;
    const struct run_request *request;
    const char *scene_hash, *image_hash;
    const struct injection_input *input;
    double start_s; /* clock_seconds() when the call began */
    sonject_progress_function progress;
    void *user;
};

/* The result of a run by rays; of the whole of it, or of all shards where the request merges, or of
 * the request's sums. Of a request for one shard its tallies, and *is_formed is false. What was
 * traced before is not traced again, and stays until checkpoints_remove. Errors: as sonject_run and
 * sonject_merge. */
sonject_status inject_by_checkpoints(const struct checkpoint_job *job,
                                     struct injection_result *result, bool *is_formed);

/* Traces everything into a file of sums. Errors: as sonject_trace. */
sonject_status trace_into_file(const struct checkpoint_job *job, const char *path);

/* Where the tallies of a run's folder are, for free(); NULL where memory lacks. */
char *checkpoints_folder(const char *folder);

/* Says that the file at path was traced by something else. Returns INPUT. */
sonject_status refuse_foreign_sums(struct report *report, const char *path, const char *what);

/* Removes the tallies of a run whose results are written. */
void checkpoints_remove(const char *folder);

#endif
