/* sonject campaign: many injections, as a data set. */
#include <stddef.h>

#include <sonject/sonject.h>

#include "stage.h"
#include "verbs.h"

struct campaign_options {
    struct stage_options stage;
    bool overwrites;
    const char *path;
    struct text_list overrides;
    const char *shard;
    struct whole_argument only;
    struct number_argument exit_after;
};

static const struct argument arguments[] = {
    {"--output", "-o", "DIR", "folder for the data set, made where missing", ARGUMENT_TEXT, true,
     offsetof(struct campaign_options, stage.output)},
    {"--set", NULL, "KEY=VALUE", "change the campaign, e.g. --set images=50; may be repeated",
     ARGUMENT_TEXTS, false, offsetof(struct campaign_options, overrides)},
    {"--shard", NULL, "I/K",
     "make only images with id mod K = I - 1; finish with sonject merge DIR", ARGUMENT_TEXT, false,
     offsetof(struct campaign_options, shard)},
    {"--only", NULL, "ID", "make only this image, even if it exists; ids count from 0",
     ARGUMENT_WHOLE, false, offsetof(struct campaign_options, only)},
    {"--exit-after", NULL, "SECONDS", "stops after this time, as after SIGTERM", ARGUMENT_NUMBER,
     false, offsetof(struct campaign_options, exit_after)},
    {"--overwrite", NULL, NULL, OVERWRITE_HELP, ARGUMENT_FLAG, false,
     offsetof(struct campaign_options, overwrites)},
    STAGE_ARGUMENTS(struct campaign_options),
};

static sonject_status make(sonject_context *context, const void *verb_options,
                           struct progress *progress, int *was_finished)
{
    const struct campaign_options *options = verb_options;
    sonject_campaign *campaign = NULL;
    const sonject_scene_read_params reading = reading_of(&options->overrides);
    sonject_campaign_run_params params = {.struct_size = sizeof(params)};
    shard_parse("campaign", options->shard, &params.shard_index, &params.shard_count);
    params.exit_after_s = options->exit_after.value;
    params.only_one = options->only.is_given;
    params.only = options->only.value;
    params.folder = options->stage.output;
    params.overwrites = options->overwrites;
    sonject_status status = sonject_campaign_read(context, options->path, &reading, &campaign);
    if (status == SONJECT_OK)
        status = sonject_campaign_run(context, campaign, &params, progress_update, progress,
                                      was_finished);
    sonject_campaign_release(&campaign);
    return status;
}

static int work(const void *verb_options)
{
    const struct campaign_options *options = verb_options;
    uint32_t index, count;
    if (!shard_parse("campaign", options->shard, &index, &count))
        return EXIT_CODE_USAGE;
    if (options->shard && options->only.is_given) {
        message("campaign: --shard and --only cannot be used together");
        return EXIT_CODE_USAGE;
    }
    const bool is_part = options->shard || options->only.is_given;
    return stage_work(&options->stage, make, verb_options,
                      is_part ? "these images are in " : "the data set is in ");
}

const struct verb campaign_verb = {
    .name = "campaign",
    .summary = "makes a labelled data set of many injections",
    .operand = "CAMPAIGN.yaml",
    .operand_offset = offsetof(struct campaign_options, path),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes =
        "Images that DIR already has are kept: after a stop, the same command continues the work.\n"
        "The bytes of all files but times.json depend only on the campaign and its inputs.",
    .options_size = sizeof(struct campaign_options),
    .work = work,
};
