/* sonject check: a scene against its image, without tracing. */
#include <stddef.h>

#include <sonject/sonject.h>

#include "stage.h"
#include "verbs.h"

struct check_options {
    struct scene_arguments scene;
};

static const struct argument arguments[] = {
    {"--set", NULL, "KEY.PATH=VALUE", "replaces or adds a key of the scene; may be repeated",
     ARGUMENT_TEXTS, false, offsetof(struct check_options, scene.overrides)},
};

static int work(const void *verb_options)
{
    const struct check_options *options = verb_options;
    sonject_context *context = NULL;
    sonject_scene *scene = NULL;
    sonject_status status = sonject_context_create(NULL, &context);
    if (status == SONJECT_OK)
        status = scene_arguments_read(context, &options->scene, &scene);
    const int code = scene_show(context, status, scene);
    sonject_scene_release(&scene);
    sonject_context_release(&context);
    return code;
}

const struct verb check_verb = {
    .name = "check",
    .summary = "checks a scene against its image and draws the geometry",
    .operand = "SCENE.yaml",
    .operand_offset = offsetof(struct check_options, scene.path),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes = "",
    .options_size = sizeof(struct check_options),
    .work = work,
};
