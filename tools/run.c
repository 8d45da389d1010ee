/* sonject run: the targets of a scene into its image. */
#include <stddef.h>

#include <sonject/sonject.h>

#include "exit_code.h"
#include "labels_argument.h"
#include "scene_arguments.h"
#include "stage.h"
#include "verbs.h"

struct run_options {
    struct stage_options stage;
    const char *labels;
    struct scene_arguments scene;
};

static const struct argument arguments[] = {
    {"--output", "-o", "DIR", "folder for the results, made where missing", ARGUMENT_TEXT, true,
     offsetof(struct run_options, stage.output)},
    SCENE_ARGUMENTS(struct run_options),
    {"--labels", NULL, "FORMATS", LABELS_HELP, ARGUMENT_TEXT, false,
     offsetof(struct run_options, labels)},
    STAGE_ARGUMENTS(struct run_options),
};

static sonject_status inject(sonject_context *context, const void *verb_options,
                             struct progress *progress, int *was_finished)
{
    const struct run_options *options = verb_options;
    sonject_scene *scene = NULL;
    sonject_run_params params;
    sonject_run_params_init(&params);
    params.folder = options->stage.output;
    labels_parse("run", options->labels, &params.labels);
    sonject_status status = scene_arguments_read(context, &options->scene, &scene);
    if (status == SONJECT_OK)
        status = sonject_run(context, scene, &params, progress_update, progress, was_finished);
    sonject_scene_release(&scene);
    return status;
}

static int work(const void *verb_options)
{
    const struct run_options *options = verb_options;
    uint32_t labels;
    if (!labels_parse("run", options->labels, &labels))
        return EXIT_CODE_USAGE;
    return stage_work(&options->stage, inject, verb_options, "the result is in ");
}

const struct verb run_verb = {
    .name = "run",
    .summary = "injects a scene's targets and writes images, masks and truth",
    .operand = "SCENE.yaml",
    .operand_offset = offsetof(struct run_options, scene.path),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes = "A folder that already holds the finished result of the same inputs is left as it is.",
    .options_size = sizeof(struct run_options),
    .work = work,
};
