/* sonject merge: the whole of what shards made. */
#include <stddef.h>

#include <sonject/sonject.h>

#include "stage.h"
#include "verbs.h"

struct merge_options {
    struct stage_options stage; /* output: the operand */
};

static const struct argument arguments[] = {
    STAGE_ARGUMENTS(struct merge_options),
};

static sonject_status merge(sonject_context *context, const void *verb_options,
                            struct progress *progress, int *was_finished)
{
    const struct merge_options *options = verb_options;
    (void)was_finished;
    return sonject_campaign_merge(context, options->stage.output, progress_update, progress);
}

static int work(const void *verb_options)
{
    const struct merge_options *options = verb_options;
    return stage_work(&options->stage, merge, verb_options, "the result is in ");
}

const struct verb merge_verb = {
    .name = "merge",
    .summary = "joins the shards of a campaign; writes what one run would",
    .operand = "DIR",
    .operand_offset = offsetof(struct merge_options, stage.output),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes = "Says which images are missing.",
    .options_size = sizeof(struct merge_options),
    .work = work,
};
