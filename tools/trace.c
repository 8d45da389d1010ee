/* sonject trace: the first stage of a run. */
#include <stddef.h>

#include <sonject/sonject.h>

#include "exit_code.h"
#include "message.h"
#include "progress.h"
#include "scene_arguments.h"
#include "stop.h"
#include "verbs.h"

struct trace_options {
    struct scene_arguments scene;
    const char *file;
    const char *device;
    bool is_verbose;
    bool is_quiet;
};

static const struct argument arguments[] = {
    {"--output", "-o", "FILE", "file of impulses to write, for sonject form", ARGUMENT_TEXT, true,
     offsetof(struct trace_options, file)},
    {"--seed", NULL, "N", "seed of the random numbers: --set injection.seed=N", ARGUMENT_WHOLE,
     false, offsetof(struct trace_options, scene.seed)},
    {"--device", NULL, "NAME", "part of an OpenCL device's name, see sonject devices",
     ARGUMENT_TEXT, false, offsetof(struct trace_options, device)},
    {"--set", NULL, "KEY.PATH=VALUE", "replaces or adds a key of the scene; may be repeated",
     ARGUMENT_TEXTS, false, offsetof(struct trace_options, scene.overrides)},
    {"--allow-user-shapes", NULL, NULL, "runs code of shapes in the scene; only if you trust it",
     ARGUMENT_FLAG, false, offsetof(struct trace_options, scene.allows_user_shapes)},
    {"--verbose", NULL, NULL, "also tells the device, what was built for it, the noise floor, ...",
     ARGUMENT_FLAG, false, offsetof(struct trace_options, is_verbose)},
    {"--quiet", NULL, NULL, "no progress bar, no news; only what is wrong", ARGUMENT_FLAG, false,
     offsetof(struct trace_options, is_quiet)},
};

static sonject_status trace(sonject_context *context, const struct trace_options *options,
                            struct progress *progress)
{
    sonject_scene *scene = NULL;
    sonject_status status = scene_arguments_read(context, &options->scene, &scene);
    if (status == SONJECT_OK) {
        sonject_trace_params params;
        sonject_trace_params_init(&params);
        params.file = options->file;
        status = sonject_trace(context, scene, &params, progress_update, progress);
    }
    sonject_scene_release(&scene);
    return status;
}

static int work(const void *verb_options)
{
    const struct trace_options *options = verb_options;
    stop_watch();
    struct progress progress;
    progress_begin(&progress, options->is_quiet);
    sonject_context_params params;
    sonject_context_params_init(&params);
    params.device_name = options->device;
    params.log = options->is_verbose && !options->is_quiet ? progress_log : NULL;
    params.log_user = &progress;
    sonject_context *context = NULL;
    sonject_status status = sonject_context_create(&params, &context);
    if (status == SONJECT_OK)
        status = trace(context, options, &progress);
    progress_end(&progress);
    int code = EXIT_CODE_DONE;
    if (status == SONJECT_CANCELLED)
        code = stop_report();
    else if (status != SONJECT_OK)
        code = fail_with(context, status);
    else if (!options->is_quiet)
        message("the impulses are in ", options->file);
    sonject_context_release(&context);
    return code;
}

const struct verb trace_verb = {
    .name = "trace",
    .summary = "traces a scene and writes its impulses, for sonject form",
    .operand = "SCENE.yaml",
    .operand_offset = offsetof(struct trace_options, scene.path),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes = "Trace at the largest bandwidth that images are to be formed with.",
    .options_size = sizeof(struct trace_options),
    .work = work,
};
