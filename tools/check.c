/* sonject check: a scene against its image, without tracing; or a campaign against its swaths. */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <sonject/sonject.h>

#include "base/system/file_system.h"
#include "stage.h"
#include "verbs.h"

static const struct argument arguments[] = {
    {"--set", NULL, "KEY.PATH=VALUE", "replaces or adds a key of the scene; may be repeated",
     ARGUMENT_TEXTS, false, offsetof(struct scene_arguments, overrides)},
};

/* A byte order mark may be before the first key. */
static bool is_campaign(const char *path)
{
    char line[256];
    bool is = false;
    uint64_t bytes;
    FILE *file = byte_file_open(path, &bytes);            /* NULL for a pipe */
    while (file && !is && fgets(line, sizeof line, file)) /* a line of YAML or JSON */
        is = strncmp(line + strspn(line, "\xEF\xBB\xBF {\""), "sonject_campaign", 16) == 0;
    if (file)
        fclose(file);
    return is;
}

static int work(const void *verb_options)
{
    const struct scene_arguments *options = verb_options;
    const bool is_whole = is_campaign(options->path);
    const sonject_context_params params = {.struct_size = sizeof params,
                                           .log = is_whole ? progress_log : NULL};
    const sonject_scene_read_params reading = reading_of(&options->overrides);
    sonject_context *context = NULL;
    sonject_campaign *campaign = NULL;
    sonject_scene *scene = NULL;
    sonject_status status = sonject_context_create(&params, &context);
    if (status == SONJECT_OK)
        status = is_whole ? sonject_campaign_read(context, options->path, &reading, &campaign)
                          : sonject_scene_read(context, options->path, &reading, &scene);
    const int code = campaign ? EXIT_CODE_DONE : scene_show(context, status, scene);
    sonject_campaign_release(&campaign);
    sonject_scene_release(&scene);
    sonject_context_release(&context);
    return code;
}

const struct verb check_verb = {
    .name = "check",
    .summary = "checks a scene and draws its geometry, or checks a campaign",
    .operand = "SCENE.yaml",
    .operand_offset = offsetof(struct scene_arguments, path),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes = "",
    .options_size = sizeof(struct scene_arguments),
    .work = work,
};
