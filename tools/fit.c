/* sonject fit: fits a campaign so that its targets measure as real contacts do. */
#include <stddef.h>
#include <string.h>

#include <sonject/sonject.h>

#include "stage.h"
#include "verbs.h"

struct fit_options {
    struct stage_options stage; /* output: the fitted campaign */
    const char *path;
    const char *contacts;
    const char *boxes;
    struct text_list classes, overrides;
};

static const struct argument arguments[] = {
    {"--output", "-o", "FITTED.yaml",
     "the fitted campaign to write, in the folder of CAMPAIGN.yaml", ARGUMENT_TEXT, true,
     offsetof(struct fit_options, stage.output)},
    {"--boxes", NULL, "both|highlight|shadow",
     "what the boxes enclose: highlight, shadow or both (both); a class with shadow or highlight "
     "in its name decides for its own boxes",
     ARGUMENT_TEXT, false, offsetof(struct fit_options, boxes)},
    {"--class", NULL, "NAME", "uses only contacts of this class; may be repeated", ARGUMENT_TEXTS,
     false, offsetof(struct fit_options, classes)},
    {"--set", NULL, "KEY=VALUE", "changes the campaign that is fitted; may be repeated",
     ARGUMENT_TEXTS, false, offsetof(struct fit_options, overrides)},
    STAGE_ARGUMENTS(struct fit_options),
};

static bool boxes_parse(const char *text, uint32_t *part)
{
    static const char *const parts[] = {[SONJECT_LABELS_BOTH] = "both",
                                        [SONJECT_LABELS_HIGHLIGHT] = "highlight",
                                        [SONJECT_LABELS_SHADOW] = "shadow"};
    *part = SONJECT_LABELS_BOTH;
    for (uint32_t i = 0; text && i < sizeof parts / sizeof *parts; i++)
        if (strcmp(text, parts[i]) == 0) {
            *part = i;
            return true;
        }
    if (text)
        message("fit: --boxes takes both, highlight or shadow, not \"", text, "\"");
    return !text;
}

static sonject_status make(sonject_context *context, const void *verb_options,
                           struct progress *progress, int *was_finished)
{
    const struct fit_options *options = verb_options;
    const sonject_scene_read_params reading = reading_of(&options->overrides);
    sonject_campaign_fit_params params = {.struct_size = sizeof(params),
                                          .contacts = options->contacts,
                                          .fitted = options->stage.output,
                                          .classes = options->classes.texts,
                                          .class_count = options->classes.count};
    (void)was_finished;
    boxes_parse(options->boxes, &params.part);
    return sonject_campaign_fit(context, options->path, &reading, &params, progress_update,
                                progress);
}

static int work(const void *verb_options)
{
    const struct fit_options *options = verb_options;
    uint32_t part;
    if (!boxes_parse(options->boxes, &part))
        return EXIT_CODE_USAGE;
    return stage_work(&options->stage, make, verb_options, "the fitted campaign is ");
}

const struct verb fit_verb = {
    .name = "fit",
    .summary = "fits a campaign's sizes, levels and noise floor to real contacts",
    .operand = "CAMPAIGN.yaml",
    .operand_offset = offsetof(struct fit_options, path),
    .second_operand = "CONTACTS",
    .second_offset = offsetof(struct fit_options, contacts),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes =
        "CONTACTS are ten or more labels in images of that sonar: a COCO file (.json), a .csv "
        "file\n"
        "(image, row, column, rows, columns) or a folder of YOLO or VOC labels; or a .yaml file "
        "of\n"
        "published quantiles. Real and injected contacts are measured alike, and the campaign's "
        "draws\n"
        "are moved until the quantiles agree. A page beside FITTED.yaml (.html) shows how well.",
    .options_size = sizeof(struct fit_options),
    .work = work,
};
