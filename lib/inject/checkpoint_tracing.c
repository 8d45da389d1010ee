/* Tracing in checkpoints, each of which ends with a file of tallies. */
#include "inject/checkpoint_tracing.h"

#include "base/clock.h"
#include "inject/traced_impulses.h"

#define CHECKPOINT_S 60.0

/* Progress of a trace: a wish to stop is noted, and the rest of the trace gone through without
 * tracing. */
static int tell(void *user, double fraction, const char *stage)
{
    struct tracing *tracing = user;
    const struct checkpoint_job *job = tracing->job;
    tracing->fraction = fraction;
    tracing->stage = stage;
    if (!tracing->is_cancelled && job->progress && job->progress(job->user, fraction, stage))
        tracing->is_cancelled = true;
    if (!tracing->is_cancelled || !tracing->checkpoint.launches || tracing->checkpoint.files)
        return tracing->is_cancelled;
    tracing->checkpoint.is_stopping = true;
    return 0;
}

static int ask(void *user)
{
    struct tracing *tracing = user;
    const struct run_request *request = tracing->job->request;
    const double now = clock_seconds();
    const double checkpoint = request->checkpoint_s > 0.0 ? request->checkpoint_s : CHECKPOINT_S;
    if (tracing->stage)
        tell(tracing, tracing->fraction, tracing->stage);
    if (request->exit_after_s > 0.0 && now - tracing->job->start_s >= request->exit_after_s)
        tracing->is_over = true;
    return tracing->is_cancelled || tracing->is_over ||
           now - tracing->checkpoint_start_s >= checkpoint;
}

static sonject_status begin_checkpoint(struct tracing *tracing, uint64_t first)
{
    const sonject_status status =
        checkpoint_begin(&tracing->checkpoint, tracing->report, tracing->folder, &tracing->head,
                         tracing->source, first);
    tracing->checkpoint.ask = ask;
    tracing->checkpoint.user = tracing;
    tracing->checkpoint_start_s = clock_seconds();
    return status;
}

/* Keeps what a checkpoint traced that ended, whether it got to the end or not. */
static sonject_status keep_checkpoint(struct tracing *tracing)
{
    const struct checkpoint *checkpoint = &tracing->checkpoint;
    if (checkpoint->next == checkpoint->first && checkpoint->next < checkpoint->strips)
        return SONJECT_OK;
    return checkpoint_publish(&tracing->checkpoint);
}

/* After a checkpoint: publishes it where tracing was cut short or is a shard's; CANCELLED where the
 * call is to end. */
static sonject_status end_checkpoint(struct tracing *tracing, sonject_status traced, uint64_t *next,
                                     bool *is_complete)
{
    struct checkpoint *checkpoint = &tracing->checkpoint;
    sonject_status status = traced;
    const bool is_through = !checkpoint->launches; /* all launches were gone through */
    if ((traced == SONJECT_OK || traced == SONJECT_CANCELLED) && is_through)
        status = keep_checkpoint(tracing);
    *next = checkpoint->next;
    *is_complete = is_through && checkpoint->next >= checkpoint->strips;
    if (status == SONJECT_OK && tracing->is_cancelled)
        status = report_failure(tracing->report, SONJECT_CANCELLED, "cancelled while tracing");
    else if (status == SONJECT_OK && tracing->is_over && !*is_complete)
        status = report_failure(tracing->report, SONJECT_CANCELLED, "stopped after %g s",
                                tracing->job->request->exit_after_s);
    checkpoint_clear(checkpoint);
    return status;
}

static sonject_status take_nothing(void *taker, const struct impulse_lines *lines)
{
    (void)taker;
    (void)lines;
    return SONJECT_OK;
}

sonject_status trace_rest(struct tracing *tracing, uint64_t next, bool is_complete)
{
    const struct checkpoint_job *job = tracing->job;
    const struct impulse_sink nobody = {take_nothing, NULL};
    struct injection_input input = *job->input;
    sonject_status status = SONJECT_OK;
    input.checkpoint = &tracing->checkpoint;
    while (status == SONJECT_OK && !is_complete) {
        struct trace_counts counts;
        CHECK(begin_checkpoint(tracing, next));
        status = injection_trace(tracing->report, job->device, job->request->scene, &input, &nobody,
                                 tell, tracing, &counts);
        status = end_checkpoint(tracing, status, &next, &is_complete);
    }
    return status;
}

sonject_status form_traced(struct tracing *tracing, struct injection_result *result)
{
    const struct checkpoint_job *job = tracing->job;
    const struct impulse_source source = traced_impulses();
    struct injection_input input = *job->input;
    input.checkpoint = &tracing->checkpoint;
    return injection_form(tracing->report, job->device, job->request->scene, &input, &source, tell,
                          tracing, result);
}

sonject_status trace_and_form(struct tracing *tracing, struct injection_result *result,
                              bool *is_formed)
{
    uint64_t next;
    bool is_complete;
    CHECK(begin_checkpoint(tracing, 0));
    sonject_status status = form_traced(tracing, result);
    *is_formed = status == SONJECT_OK;
    if (*is_formed) {
        checkpoint_clear(&tracing->checkpoint);
        return SONJECT_OK;
    }
    status = end_checkpoint(tracing, status, &next, &is_complete);
    return status == SONJECT_OK ? trace_rest(tracing, next, is_complete) : status;
}
