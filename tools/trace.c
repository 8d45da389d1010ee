/* sonject trace: the first stage of a run. */
#include <stddef.h>

#include <sonject/sonject.h>

#include "stage.h"
#include "verbs.h"

struct trace_options {
    struct stage_options stage;
    struct scene_arguments scene;
};

static const struct argument arguments[] = {
    {"--output", "-o", "FILE", "file of sums to write, for sonject form", ARGUMENT_TEXT, true,
     offsetof(struct trace_options, stage.output)},
    SCENE_ARGUMENTS(struct trace_options),
    STAGE_ARGUMENTS(struct trace_options),
};

static sonject_status trace(sonject_context *context, const void *verb_options,
                            struct progress *progress, int *was_finished)
{
    (void)was_finished;
    const struct trace_options *options = verb_options;
    sonject_scene *scene = NULL;
    sonject_status status = scene_arguments_read(context, &options->scene, &scene);
    if (status == SONJECT_OK)
        status = sonject_trace(context, scene, options->stage.output, progress_update, progress);
    sonject_scene_release(&scene);
    return status;
}

static int work(const void *verb_options)
{
    const struct trace_options *options = verb_options;
    return stage_work(&options->stage, trace, verb_options, "the sums are in ");
}

const struct verb trace_verb = {
    .name = "trace",
    .summary = "traces a scene and writes its sums, for sonject form",
    .operand = "SCENE.yaml",
    .operand_offset = offsetof(struct trace_options, scene.path),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes = "Trace at the largest bandwidth that images are to be formed with.",
    .options_size = sizeof(struct trace_options),
    .work = work,
};
