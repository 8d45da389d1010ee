/* One call's work on the tallies of a run: whose they are, and what is traced to them. */
#ifndef SONJECT_INJECT_CHECKPOINT_TRACING_H
#define SONJECT_INJECT_CHECKPOINT_TRACING_H

#include "inject/checkpoints.h"
#include "trace/checkpoint.h"
#include "trace/sums_folder.h"

/* One call's tracing. */
struct tracing {
    const struct checkpoint_job *job;
    struct report *report;
    char *folder; /* work; owned */
    struct sums_head head;
    struct sums_source source; /* owned texts */
    struct checkpoint checkpoint;
    double checkpoint_start_s;
    double fraction; /* that was told last */
    const char *stage;
    bool is_cancelled, is_over; /* by the caller; its time */
};

/* Fills in the head of what this call traces. Errors: MEMORY. */
sonject_status take_sums_head(struct tracing *tracing);

/* Work of shards of another number, or of a whole run and of shards, does not go together. Errors:
 * INPUT, STORAGE, MEMORY. */
sonject_status check_shards(struct tracing *tracing);

/* What is in the folder must be this scene's; what an earlier whole run left of another is dropped.
 * Errors: INPUT. */
sonject_status check_folder(struct tracing *tracing, struct sums_folder *folder);

/* The same of all shards, whose number the head gets. The folder must not be empty. */
sonject_status check_merged(struct tracing *tracing, const struct sums_folder *folder);

/* Traces all in one go and forms the result as it does, or, where it is stopped between, keeps what
 * was traced and traces the rest. *is_formed: whether there is a result. Errors: as sonject_run. */
sonject_status trace_and_form(struct tracing *tracing, struct injection_result *result,
                              bool *is_formed);

/* Traces from a strip of the shard on, checkpoint by checkpoint, to its end. */
sonject_status trace_rest(struct tracing *tracing, uint64_t next, bool is_complete);

/* Forms the result from tracing->checkpoint. */
sonject_status form_traced(struct tracing *tracing, struct injection_result *result);

#endif
