/* sonject run: puts the targets of a scene into its image. */
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/sonject.h>

#include "stage.h"
#include "verbs.h"

struct run_options {
    struct stage_options stage;
    bool overwrites;
    const char *labels;
    struct scene_arguments scene;
    const char *shard;
    struct number_argument exit_after, checkpoint;
};

static const struct argument arguments[] = {
    {"--output", "-o", "DIR", "folder for the results, made where missing", ARGUMENT_TEXT, true,
     offsetof(struct run_options, stage.output)},
    SCENE_ARGUMENTS(struct run_options),
    {"--labels", NULL, "FORMATS", LABELS_HELP, ARGUMENT_TEXT, false,
     offsetof(struct run_options, labels)},
    {"--shard", NULL, "I/K", "traces part I of K; sonject merge joins the parts 1/K to K/K",
     ARGUMENT_TEXT, false, offsetof(struct run_options, shard)},
    {"--exit-after", NULL, "SECONDS", "stops tracing after this time, as after SIGTERM",
     ARGUMENT_NUMBER, false, offsetof(struct run_options, exit_after)},
    {"--checkpoint", NULL, "SECONDS", "time between checkpoints (60)", ARGUMENT_NUMBER, false,
     offsetof(struct run_options, checkpoint)},
    {"--overwrite", NULL, NULL, OVERWRITE_HELP, ARGUMENT_FLAG, false,
     offsetof(struct run_options, overwrites)},
    STAGE_ARGUMENTS(struct run_options),
};

/* Runs one band of the scene into a folder; band NULL: the scene leaves none to be chosen. */
static sonject_status inject_band(sonject_context *context, const struct run_options *options,
                                  const char *band, const char *folder, struct progress *progress,
                                  int *was_finished)
{
    struct scene_arguments of_band = options->scene;
    sonject_scene *scene = NULL;
    sonject_run_params params = {.struct_size = sizeof(params)};
    params.folder = folder;
    params.overwrites = options->overwrites;
    labels_parse("run", options->labels, &params.labels);
    params.exit_after_s = options->exit_after.value;
    params.checkpoint_s = options->checkpoint.value;
    shard_parse("run", options->shard, &params.shard_index, &params.shard_count);
    of_band.band = band;
    sonject_status status = scene_arguments_read(context, &of_band, &scene);
    if (status == SONJECT_OK)
        status = sonject_run(context, scene, &params, progress_update, progress, was_finished);
    sonject_scene_release(&scene);
    return status;
}

/* Runs each band of names, one a line, into a folder of its own. *was_finished is 1 if all were
 * finished. names is cut into pieces. */
static sonject_status inject_bands(sonject_context *context, const struct run_options *options,
                                   char *names, struct progress *progress, int *was_finished)
{
    const size_t bytes = strlen(options->stage.output) + strlen(names) + 2;
    char *folder = malloc(bytes);
    sonject_status status = folder ? SONJECT_OK : SONJECT_ERROR_MEMORY;
    *was_finished = 1;
    while (status == SONJECT_OK && *names) {
        int was_band_finished = 0;
        char *end = strchr(names, '\n');
        *end = '\0';
        snprintf(folder, bytes, "%s/%s", options->stage.output, names);
        status = inject_band(context, options, names, folder, progress, &was_band_finished);
        *was_finished = *was_finished && was_band_finished;
        names = end + 1;
    }
    free(folder);
    return status;
}

static sonject_status inject(sonject_context *context, const void *verb_options,
                             struct progress *progress, int *was_finished)
{
    const struct run_options *options = verb_options;
    char *names = NULL;
    sonject_status status = scene_arguments_bands(context, &options->scene, &names);
    if (status == SONJECT_OK && *names)
        status = inject_bands(context, options, names, progress, was_finished);
    else if (status == SONJECT_OK)
        status = inject_band(context, options, NULL, options->stage.output, progress, was_finished);
    sonject_text_release(&names);
    return status;
}

static int work(const void *verb_options)
{
    const struct run_options *options = verb_options;
    uint32_t labels, index, count;
    if (!labels_parse("run", options->labels, &labels) ||
        !shard_parse("run", options->shard, &index, &count))
        return EXIT_CODE_USAGE;
    return stage_work(&options->stage, inject, verb_options,
                      options->shard ? "the shard is done; after all shards, run sonject merge "
                                     : "the result is in ");
}

const struct verb run_verb = {
    .name = "run",
    .summary = "injects a scene's targets and writes images, masks and truth",
    .operand = "SCENE.yaml",
    .operand_offset = offsetof(struct run_options, scene.path),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes =
        "A folder that already holds the finished result of the same inputs is left as it is; one\n"
        "with another result, or with other files of its names, is refused unless --overwrite is\n"
        "given.\n"
        "Each band of a scene goes to a folder of its name; --set band=NAME runs only that band.\n"
        "A run that was stopped continues from DIR/work. Shards of a run need the same DIR and\n"
        "scene; they may run on different machines, at any time, and be repeated.",
    .options_size = sizeof(struct run_options),
    .work = work,
};
