/* sonject check: a scene against its image, without tracing. */
#include <stdio.h>

#include <sonject/sonject.h>

#include "exit_code.h"
#include "verbs.h"

struct check_options {
    const char *scene;
    struct text_list overrides;
    bool allows_user_shapes;
};

static const struct argument arguments[] = {
    {"--set", NULL, "KEY.PATH=VALUE", "replaces or adds a key of the scene; may be repeated",
     ARGUMENT_TEXTS, false, offsetof(struct check_options, overrides)},
    {"--allow-user-shapes", NULL, NULL, "tries code of shapes in the scene; only if you trust it",
     ARGUMENT_FLAG, false, offsetof(struct check_options, allows_user_shapes)},
};

static sonject_status describe(sonject_context *context, const struct check_options *options,
                               char **text)
{
    sonject_scene *scene = NULL;
    const sonject_scene_read_params params = {.struct_size = sizeof(params),
                                              .allows_user_shapes = options->allows_user_shapes,
                                              .overrides = options->overrides.texts,
                                              .override_count = (uint32_t)options->overrides.count};
    sonject_status status = sonject_scene_read(context, options->scene, &params, &scene);
    if (status == SONJECT_OK)
        status = sonject_check(context, scene, text);
    sonject_scene_release(&scene);
    return status;
}

static int work(const void *verb_options)
{
    sonject_context *context = NULL;
    char *text = NULL;
    sonject_status status = sonject_context_create(NULL, &context);
    if (status == SONJECT_OK)
        status = describe(context, verb_options, &text);
    int code = EXIT_CODE_DONE;
    if (status == SONJECT_OK) {
        fputs(text, stdout);
        code = finish_output();
    } else {
        code = fail_with(context, status);
    }
    sonject_text_release(&text);
    sonject_context_release(&context);
    return code;
}

const struct verb check_verb = {
    .name = "check",
    .summary = "checks a scene against its image and draws the geometry",
    .operand = "SCENE.yaml",
    .operand_offset = offsetof(struct check_options, scene),
    .arguments = arguments,
    .argument_count = sizeof(arguments) / sizeof(arguments[0]),
    .notes = "",
    .options_size = sizeof(struct check_options),
    .work = work,
};
