/* sonject form: the second stage of a run, from the sums of sonject trace. */
#include <stddef.h>

#include <sonject/sonject.h>

#include "stage.h"
#include "verbs.h"

struct form_options {
    struct stage_options stage;
    bool overwrites;
    const char *labels;
    const char *file;
    struct text_list overrides;
};

static const struct argument arguments[] = {
    {"--output", "-o", "DIR", "folder for the results, made where missing", ARGUMENT_TEXT, true,
     offsetof(struct form_options, stage.output)},
    {"--set", NULL, "KEY.PATH=VALUE",
     "another pulse, bandwidth, resolution, response or motion; may be repeated", ARGUMENT_TEXTS,
     false, offsetof(struct form_options, overrides)},
    {"--labels", NULL, "FORMATS", LABELS_HELP, ARGUMENT_TEXT, false,
     offsetof(struct form_options, labels)},
    {"--overwrite", NULL, NULL, OVERWRITE_HELP, ARGUMENT_FLAG, false,
     offsetof(struct form_options, overwrites)},
    STAGE_ARGUMENTS(struct form_options),
};

static sonject_status form(sonject_context *context, const void *verb_options,
                           struct progress *progress, int *was_finished)
{
    const struct form_options *options = verb_options;
    sonject_form_params params = {.struct_size = sizeof(params)};
    params.file = options->file;
    params.folder = options->stage.output;
    params.overwrites = options->overwrites;
    labels_parse("form", options->labels, &params.labels);
    params.overrides = (const char *const *)options->overrides.texts;
    params.override_count = (uint32_t)options->overrides.count;
    return sonject_form(context, NULL, &params, progress_update, progress, was_finished);
}

static int work(const void *verb_options)
{
    const struct form_options *options = verb_options;
    uint32_t labels;
    if (!labels_parse("form", options->labels, &labels))
        return EXIT_CODE_USAGE;
    return stage_work(&options->stage, form, verb_options, "the result is in ");
}

const struct verb form_verb = {
    .name = "form",
    .summary = "forms the image from a file of sonject trace; writes the files that run writes",
    .operand = "FILE",
    .operand_offset = offsetof(struct form_options, file),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes =
        "--set takes sonar.bandwidth, .pulse, .resolution, .response, .measured_response and\n"
        ".motion, and input.path for an image that was moved. The scene's files and image must\n"
        "be those that were traced. Shadows and rough highlights keep the resolution and the\n"
        "response that were traced.",
    .options_size = sizeof(struct form_options),
    .work = work,
};
