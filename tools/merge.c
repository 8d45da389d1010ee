/* sonject merge: joins the work of all shards. */
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/sonject.h>

#include "base/system/file_system.h"
#include "stage.h"
#include "verbs.h"

struct merge_options {
    struct stage_options stage; /* output: the operand, the folder */
    const char *labels;
};

static const struct argument arguments[] = {
    {"--labels", NULL, "FORMATS", LABELS_HELP, ARGUMENT_TEXT, false,
     offsetof(struct merge_options, labels)},
    STAGE_ARGUMENTS(struct merge_options),
};

static sonject_status merge_run(sonject_context *context, const struct merge_options *options,
                                struct progress *progress, int *was_finished)
{
    sonject_merge_params params = {.struct_size = sizeof(params)};
    params.folder = options->stage.output;
    labels_parse("merge", options->labels, &params.labels);
    return sonject_merge(context, NULL, &params, progress_update, progress, was_finished);
}

/* Returns whether a folder holds a campaign, whose shards begin with its campaign.json. */
static bool holds_campaign(const char *folder)
{
    static const char name[] = "/campaign.json";
    const size_t bytes = strlen(folder) + sizeof name;
    char *path = malloc(bytes);
    if (path)
        snprintf(path, bytes, "%s%s", folder, name);
    const bool is_there = path && file_exists(path);
    free(path);
    return is_there;
}

static sonject_status merge(sonject_context *context, const void *verb_options,
                            struct progress *progress, int *was_finished)
{
    const struct merge_options *options = verb_options;
    const char *folder = options->stage.output;
    return holds_campaign(folder)
               ? sonject_campaign_merge(context, folder, progress_update, progress)
               : merge_run(context, options, progress, was_finished);
}

static int work(const void *verb_options)
{
    const struct merge_options *options = verb_options;
    uint32_t labels;
    if (!labels_parse("merge", options->labels, &labels))
        return EXIT_CODE_USAGE;
    if (options->labels && holds_campaign(options->stage.output)) {
        message("merge: a campaign's file chooses its labels: take --labels out");
        return EXIT_CODE_USAGE;
    }
    return stage_work(&options->stage, merge, verb_options, "the result is in ");
}

const struct verb merge_verb = {
    .name = "merge",
    .summary = "joins the shards of a run or campaign; writes what one run would",
    .operand = "DIR",
    .operand_offset = offsetof(struct merge_options, stage.output),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes =
        "Says which shards or images are missing. The image and other files of a run's scene\n"
        "must be unchanged, and in the places where its shards found them. Of a scene with bands,\n"
        "all bands below DIR are merged.",
    .options_size = sizeof(struct merge_options),
    .work = work,
};
