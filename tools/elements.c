/* sonject elements: time series of the hydrophones of an array. */
#include <stddef.h>

#include <sonject/sonject.h>

#include "stage.h"
#include "verbs.h"

struct elements_options {
    struct stage_options stage;
    bool overwrites;
    struct scene_arguments scene;
};

static const struct argument arguments[] = {
    {"--output", "-o", "DIR", "folder for series.npy and elements.json, made where missing",
     ARGUMENT_TEXT, true, offsetof(struct elements_options, stage.output)},
    SCENE_ARGUMENTS(struct elements_options),
    {"--overwrite", NULL, NULL, OVERWRITE_HELP, ARGUMENT_FLAG, false,
     offsetof(struct elements_options, overwrites)},
    STAGE_ARGUMENTS(struct elements_options),
};

static sonject_status write_series(sonject_context *context, const void *verb_options,
                                   struct progress *progress, int *was_finished)
{
    (void)was_finished;
    const struct elements_options *options = verb_options;
    sonject_scene *scene = NULL;
    sonject_run_params params = {.struct_size = sizeof(params)};
    params.folder = options->stage.output;
    params.overwrites = options->overwrites;
    sonject_status status = scene_arguments_read(context, &options->scene, &scene);
    if (status == SONJECT_OK)
        status = sonject_elements_run(context, scene, &params, progress_update, progress);
    sonject_scene_release(&scene);
    return status;
}

static int work(const void *verb_options)
{
    const struct elements_options *options = verb_options;
    return stage_work(&options->stage, write_series, verb_options, "the series are in ");
}

const struct verb elements_verb = {
    .name = "elements",
    .summary = "writes the time series of each hydrophone of an array, ping by ping",
    .operand = "SCENE.yaml",
    .operand_offset = offsetof(struct elements_options, scene.path),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes = "The scene's section elements describes the array. series.npy is [ping, hydrophone, "
             "sample];\n"
             "elements.json has positions and times. In composite mode, the series hold only the "
             "targets.",
    .options_size = sizeof(struct elements_options),
    .work = work,
};
