/* Tracing that is shared out, and that can be stopped and gone on with: tallies in a run's folder
 * work. */
#ifndef SONJECT_API_CHECKPOINTS_H
#define SONJECT_API_CHECKPOINTS_H

#include "api/run_scene.h"

#define SHARDS_MAX 9999

struct checkpoint_job {
    struct sonject_context *context;
    struct device *device;
    const struct run_request *request;
    const char *scene_hash;
    const struct injection_input *input;
    double start_s; /* clock_seconds() when the call began */
    sonject_progress_function progress;
    void *user;
};

/* The result of a run by rays; of the whole of it, or of all shards where the request merges. Of a
 * request for one shard its tallies, and *is_formed is false. What was traced before is not traced
 * again, and stays until checkpoints_remove. Errors: as sonject_run and sonject_merge. */
sonject_status inject_by_checkpoints(const struct checkpoint_job *job,
                                     struct injection_result *result, bool *is_formed);

/* Where the tallies of a run's folder are, for free(); NULL where memory lacks. */
char *checkpoints_folder(const char *folder);

/* Says that the file at path was traced by something else. Returns INPUT. */
sonject_status refuse_foreign_sums(struct report *report, const char *path, const char *what);

/* Removes the tallies of a run whose results are written. */
void checkpoints_remove(const char *folder);

#endif
