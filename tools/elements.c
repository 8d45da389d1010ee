/* sonject elements: time series of the hydrophones of an array. */
#include <stddef.h>

#include <sonject/sonject.h>

#include "exit_code.h"
#include "message.h"
#include "progress.h"
#include "scene_arguments.h"
#include "stop.h"
#include "verbs.h"

struct elements_options {
    struct scene_arguments scene;
    const char *folder;
    const char *device;
    bool is_quiet;
};

static const struct argument arguments[] = {
    {"--output", "-o", "DIR", "folder for series.npy and elements.json, made where missing",
     ARGUMENT_TEXT, true, offsetof(struct elements_options, folder)},
    {"--seed", NULL, "N", "seed of the random numbers: --set injection.seed=N", ARGUMENT_WHOLE,
     false, offsetof(struct elements_options, scene.seed)},
    {"--device", NULL, "NAME", "part of an OpenCL device's name, see sonject devices",
     ARGUMENT_TEXT, false, offsetof(struct elements_options, device)},
    {"--set", NULL, "KEY.PATH=VALUE", "replaces or adds a key of the scene; may be repeated",
     ARGUMENT_TEXTS, false, offsetof(struct elements_options, scene.overrides)},
    {"--allow-user-shapes", NULL, NULL, "runs code of shapes in the scene; only if you trust it",
     ARGUMENT_FLAG, false, offsetof(struct elements_options, scene.allows_user_shapes)},
    {"--quiet", NULL, NULL, "no progress bar, no news; only what is wrong", ARGUMENT_FLAG, false,
     offsetof(struct elements_options, is_quiet)},
};

static sonject_status write_series(sonject_context *context, const struct elements_options *options,
                                   struct progress *progress)
{
    sonject_scene *scene = NULL;
    sonject_run_params params;
    sonject_run_params_init(&params);
    params.folder = options->folder;
    sonject_status status = scene_arguments_read(context, &options->scene, &scene);
    if (status == SONJECT_OK)
        status = sonject_elements_run(context, scene, &params, progress_update, progress);
    sonject_scene_release(&scene);
    return status;
}

static int work(const void *verb_options)
{
    const struct elements_options *options = verb_options;
    stop_watch();
    struct progress progress;
    progress_begin(&progress, options->is_quiet);
    sonject_context_params params;
    sonject_context_params_init(&params);
    params.device_name = options->device;
    sonject_context *context = NULL;
    sonject_status status = sonject_context_create(&params, &context);
    if (status == SONJECT_OK)
        status = write_series(context, options, &progress);
    progress_end(&progress);
    int code = EXIT_CODE_DONE;
    if (status == SONJECT_CANCELLED)
        code = stop_report();
    else if (status != SONJECT_OK)
        code = fail_with(context, status);
    else if (!options->is_quiet)
        message("the series are in ", options->folder);
    sonject_context_release(&context);
    return code;
}

const struct verb elements_verb = {
    .name = "elements",
    .summary = "writes what each hydrophone of an array hears of a scene, ping by ping",
    .operand = "SCENE.yaml",
    .operand_offset = offsetof(struct elements_options, scene.path),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes =
        "The array is the scene's section elements. series.npy is [ping, hydrophone, sample];\n"
        "elements.json says where and when. In composite mode only targets are heard.",
    .options_size = sizeof(struct elements_options),
    .work = work,
};
