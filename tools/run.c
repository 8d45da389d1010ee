/* sonject run: the targets of a scene into its image. */
#include <stddef.h>

#include <sonject/sonject.h>

#include "exit_code.h"
#include "message.h"
#include "progress.h"
#include "scene_arguments.h"
#include "stop.h"
#include "verbs.h"

struct run_options {
    struct scene_arguments scene;
    const char *folder;
    const char *device;
    bool is_verbose;
    bool is_quiet;
};

static const struct argument arguments[] = {
    {"--output", "-o", "DIR", "folder for the results, made where missing", ARGUMENT_TEXT, true,
     offsetof(struct run_options, folder)},
    {"--seed", NULL, "N", "seed of the random numbers: --set injection.seed=N", ARGUMENT_WHOLE,
     false, offsetof(struct run_options, scene.seed)},
    {"--device", NULL, "NAME", "part of an OpenCL device's name, see sonject devices",
     ARGUMENT_TEXT, false, offsetof(struct run_options, device)},
    {"--set", NULL, "KEY.PATH=VALUE", "replaces or adds a key of the scene; may be repeated",
     ARGUMENT_TEXTS, false, offsetof(struct run_options, scene.overrides)},
    {"--allow-user-shapes", NULL, NULL, "runs code of shapes in the scene; only if you trust it",
     ARGUMENT_FLAG, false, offsetof(struct run_options, scene.allows_user_shapes)},
    {"--verbose", NULL, NULL, "also tells the device, what was built for it, the noise floor, ...",
     ARGUMENT_FLAG, false, offsetof(struct run_options, is_verbose)},
    {"--quiet", NULL, NULL, "no progress bar, no news; only what is wrong", ARGUMENT_FLAG, false,
     offsetof(struct run_options, is_quiet)},
};

static sonject_status inject(sonject_context *context, const struct run_options *options,
                             struct progress *progress, int *was_finished)
{
    sonject_scene *scene = NULL;
    sonject_status status = scene_arguments_read(context, &options->scene, &scene);
    if (status == SONJECT_OK) {
        sonject_run_params params;
        sonject_run_params_init(&params);
        params.folder = options->folder;
        status = sonject_run(context, scene, &params, progress_update, progress, was_finished);
    }
    sonject_scene_release(&scene);
    return status;
}

static int work(const void *verb_options)
{
    const struct run_options *options = verb_options;
    stop_watch();
    struct progress progress;
    progress_begin(&progress, options->is_quiet);
    sonject_context_params params;
    sonject_context_params_init(&params);
    params.device_name = options->device;
    params.log = options->is_verbose && !options->is_quiet ? progress_log : NULL;
    params.log_user = &progress;
    sonject_context *context = NULL;
    int was_finished = 0;
    sonject_status status = sonject_context_create(&params, &context);
    if (status == SONJECT_OK)
        status = inject(context, options, &progress, &was_finished);
    progress_end(&progress);
    int code = EXIT_CODE_DONE;
    if (status == SONJECT_CANCELLED)
        code = stop_report();
    else if (status != SONJECT_OK)
        code = fail_with(context, status);
    else if (!options->is_quiet && was_finished)
        message(options->folder, " already holds the finished result");
    else if (!options->is_quiet)
        message("the result is in ", options->folder);
    sonject_context_release(&context);
    return code;
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
