#include "stage.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

int stage_work(const struct stage_options *stage, stage_function function, const void *verb_options,
               const char *done)
{
    stop_watch();
    struct progress progress;
    progress_begin(&progress, stage->is_quiet);
    sonject_context_params params = {.struct_size = sizeof(params)};
    params.device_name = stage->device;
    params.log = stage->is_quiet ? NULL : stage->is_verbose ? progress_log : progress_note;
    params.log_user = &progress;
    sonject_context *context = NULL;
    int was_finished = 0;
    sonject_status status = sonject_context_create(&params, &context);
    if (status == SONJECT_OK)
        status = function(context, verb_options, &progress, &was_finished);
    progress_end(&progress);
    int code = EXIT_CODE_DONE;
    /* A driver's compiler fails, after removing its files, if a signal interrupts it. */
    if (status == SONJECT_CANCELLED || (status == SONJECT_ERROR_DEVICE && stop_is_asked()))
        code = stop_report();
    else if (status != SONJECT_OK)
        code = fail_with(context, status);
    else if (!stage->is_quiet && was_finished)
        message(stage->output, " already holds the finished result");
    else if (!stage->is_quiet)
        message(done, stage->output);
    sonject_context_release(&context);
    return code;
}

sonject_scene_read_params reading_of(const struct text_list *overrides)
{
    return (sonject_scene_read_params){.struct_size = sizeof(sonject_scene_read_params),
                                       .overrides = overrides->texts,
                                       .override_count = (uint32_t)overrides->count};
}

sonject_status scene_arguments_bands(sonject_context *context,
                                     const struct scene_arguments *arguments, char **names)
{
    const sonject_scene_read_params params = reading_of(&arguments->overrides);
    return sonject_scene_bands(context, arguments->path, &params, names);
}

sonject_status scene_arguments_read(sonject_context *context,
                                    const struct scene_arguments *arguments, sonject_scene **scene)
{
    char seed[48];
    char band[SONJECT_NAME_CAPACITY + 8];
    size_t count = arguments->overrides.count;
    const char **overrides = calloc(count + 2, sizeof(*overrides));
    if (!overrides)
        return SONJECT_ERROR_MEMORY;
    if (count > 0)
        memcpy(overrides, arguments->overrides.texts, count * sizeof(*overrides));
    snprintf(seed, sizeof(seed), "injection.seed=%llu", (unsigned long long)arguments->seed.value);
    if (arguments->seed.is_given)
        overrides[count++] = seed;
    if (arguments->band) {
        snprintf(band, sizeof(band), "band=%s", arguments->band);
        overrides[count++] = band;
    }
    const sonject_scene_read_params params = {
        .struct_size = sizeof(params), .overrides = overrides, .override_count = (uint32_t)count};
    const sonject_status status = sonject_scene_read(context, arguments->path, &params, scene);
    free(overrides);
    return status;
}

int scene_show(sonject_context *context, sonject_status status, const sonject_scene *scene)
{
    char *text = NULL;
    if (status == SONJECT_OK)
        status = sonject_check(context, scene, &text);
    if (text)
        fputs(text, stdout);
    sonject_text_release(&text);
    return status == SONJECT_OK ? finish_output() : fail_with(context, status);
}

static bool parse_shard(const char *text, uint64_t *part, uint64_t *whole)
{
    char first[16];
    const char *slash = strchr(text, '/');
    if (!slash || (size_t)(slash - text) >= sizeof first)
        return false;
    memcpy(first, text, (size_t)(slash - text));
    first[slash - text] = '\0';
    return text_to_count(first, part) && text_to_count(slash + 1, whole) && *part >= 1 &&
           *part <= *whole && *whole <= UINT32_MAX;
}

bool shard_parse(const char *verb, const char *text, uint32_t *index, uint32_t *count)
{
    uint64_t part, whole;
    if (!text)
        return true;
    if (!parse_shard(text, &part, &whole)) {
        message(verb, ": --shard takes I/K, whole numbers with I from 1 to K, not \"", text, "\"");
        return false;
    }
    *index = (uint32_t)part;
    *count = (uint32_t)whole;
    return true;
}

static const struct {
    const char *name;
    uint32_t format;
} label_formats[] = {{"yolo", SONJECT_LABELS_YOLO}, {"voc", SONJECT_LABELS_VOC}};

static uint32_t format_named(const char *name, size_t length)
{
    for (size_t i = 0; i < sizeof label_formats / sizeof *label_formats; i++)
        if (strlen(label_formats[i].name) == length &&
            strncmp(label_formats[i].name, name, length) == 0)
            return label_formats[i].format;
    return 0;
}

bool labels_parse(const char *verb, const char *text, uint32_t *labels)
{
    *labels = 0;
    for (const char *name = text; name;) {
        const size_t length = strcspn(name, ",");
        const uint32_t format = format_named(name, length);
        if (format == 0) {
            message(verb, ": --labels takes yolo, voc, or yolo,voc, not \"", text, "\"");
            return false;
        }
        *labels |= format;
        name = name[length] == ',' ? name + length + 1 : NULL;
    }
    return true;
}
