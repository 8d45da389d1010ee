/* sonject form: the second stage of a run, from the impulses of sonject trace. */
#include <stddef.h>

#include <sonject/sonject.h>

#include "exit_code.h"
#include "message.h"
#include "progress.h"
#include "stop.h"
#include "verbs.h"

struct form_options {
    const char *file;
    struct text_list overrides;
    const char *folder;
    const char *device;
    bool is_verbose;
    bool is_quiet;
};

static const struct argument arguments[] = {
    {"--output", "-o", "DIR", "folder for the results, made where missing", ARGUMENT_TEXT, true,
     offsetof(struct form_options, folder)},
    {"--device", NULL, "NAME", "part of an OpenCL device's name, see sonject devices",
     ARGUMENT_TEXT, false, offsetof(struct form_options, device)},
    {"--set", NULL, "KEY.PATH=VALUE", "another bandwidth, resolution or response; may be repeated",
     ARGUMENT_TEXTS, false, offsetof(struct form_options, overrides)},
    {"--verbose", NULL, NULL, "also tells the device, what was built for it, the noise floor, ...",
     ARGUMENT_FLAG, false, offsetof(struct form_options, is_verbose)},
    {"--quiet", NULL, NULL, "no progress bar, no news; only what is wrong", ARGUMENT_FLAG, false,
     offsetof(struct form_options, is_quiet)},
};

static sonject_status form(sonject_context *context, const struct form_options *options,
                           struct progress *progress, int *was_finished)
{
    sonject_form_params params;
    sonject_form_params_init(&params);
    params.file = options->file;
    params.folder = options->folder;
    params.overrides = (const char *const *)options->overrides.texts;
    params.override_count = (uint32_t)options->overrides.count;
    return sonject_form(context, NULL, &params, progress_update, progress, was_finished);
}

static int work(const void *verb_options)
{
    const struct form_options *options = verb_options;
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
        status = form(context, options, &progress, &was_finished);
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

const struct verb form_verb = {
    .name = "form",
    .summary = "forms the image of traced impulses; writes what run does",
    .operand = "FILE",
    .operand_offset = offsetof(struct form_options, file),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes =
        "--set takes sonar.bandwidth, sonar.resolution, sonar.response, and input.path for an\n"
        "image that was moved. The scene's files and image must be those that were traced.",
    .options_size = sizeof(struct form_options),
    .work = work,
};
