#include "api/handles.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "schema/scene_file.h"

sonject_status sonject_scene_create(sonject_context *context, sonject_scene **scene)
{
    if (!context || !scene)
        return SONJECT_ERROR_ARGUMENT;
    context_begin_call(context);
    *scene = allocate_array(1, sizeof **scene);
    if (!*scene)
        return report_out_of_memory(&context->report, "a scene");
    (*scene)->report = &context->report;
    scene_init(&(*scene)->scene);
    return SONJECT_OK;
}

static void source_clear(struct scene_source *source)
{
    for (size_t i = 0; i < source->override_count; i++)
        free(source->overrides[i]);
    free(source->overrides);
    free(source->path);
    free(source->text);
    memset(source, 0, sizeof *source);
}

void sonject_scene_release(sonject_scene **scene)
{
    if (!scene || !*scene)
        return;
    scene_clear(&(*scene)->scene);
    source_clear(&(*scene)->source);
    free(*scene);
    *scene = NULL;
}

/* Keeps what the scene is read from; takes the text over. */
static sonject_status source_keep(struct scene_source *source, struct report *report,
                                  const char *path, char *text, const char *const *overrides,
                                  size_t count)
{
    source->text = text;
    source->path = copy_text(path);
    source->overrides = allocate_array(count, sizeof *source->overrides);
    bool is_whole = source->path && source->overrides;
    for (size_t i = 0; is_whole && i < count; i++) {
        source->overrides[i] = copy_text(overrides[i]);
        is_whole = source->overrides[i] != NULL;
        source->override_count = i + 1;
    }
    return is_whole ? SONJECT_OK : report_out_of_memory(report, "a scene");
}

static sonject_status read_file(struct sonject_scene *scene, const char *path,
                                const char *const *overrides, size_t count, bool allows_user_shapes)
{
    char *text;
    size_t bytes;
    sonject_status status = scene_file_load(scene->report, path, &text, &bytes);
    THEN(status, source_keep(&scene->source, scene->report, path, text, overrides, count));
    if (status != SONJECT_OK)
        return status;
    const struct scene_text source = {path,  text, bytes, overrides,
                                      count, NULL, 0,     allows_user_shapes};
    return scene_text_read(scene->report, &source, &scene->scene);
}

static sonject_status check_overrides(struct report *report, const char *path,
                                      const char *const *overrides, size_t count)
{
    if (!path || (count > 0 && !overrides))
        return null_argument(report, "path and overrides");
    for (size_t i = 0; i < count; i++)
        if (!overrides[i])
            return null_argument(report, "an override");
    return SONJECT_OK;
}

sonject_status sonject_scene_bands(sonject_context *context, const char *path,
                                   const char *const *overrides, size_t count, char **names)
{
    if (!context)
        return SONJECT_ERROR_ARGUMENT;
    context_begin_call(context);
    struct report *report = &context->report;
    if (!names)
        return null_argument(report, "names");
    *names = NULL;
    char *text;
    size_t bytes;
    sonject_status status = check_overrides(report, path, overrides, count);
    THEN(status, scene_file_load(report, path, &text, &bytes));
    if (status != SONJECT_OK)
        return status;
    const struct scene_text source = {path, text, bytes, overrides, count, NULL, 0, false};
    status = scene_text_bands(report, &source, names);
    free(text);
    return status;
}

void sonject_scene_read_params_init(sonject_scene_read_params *params)
{
    memset(params, 0, sizeof *params);
    params->struct_size = sizeof *params;
}

sonject_status sonject_scene_read(sonject_context *context, const char *path,
                                  const char *const *overrides, size_t count, sonject_scene **scene)
{
    sonject_scene_read_params params;
    sonject_scene_read_params_init(&params);
    return sonject_scene_read_with(context, path, overrides, count, &params, scene);
}

sonject_status sonject_scene_read_with(sonject_context *context, const char *path,
                                       const char *const *overrides, size_t count,
                                       const sonject_scene_read_params *params,
                                       sonject_scene **scene)
{
    if (!context || !scene)
        return SONJECT_ERROR_ARGUMENT;
    *scene = NULL;
    context_begin_call(context);
    sonject_scene_read_params taken;
    sonject_scene_read_params_init(&taken);
    sonject_status status = params_take(&context->report, &taken, sizeof taken, params,
                                        sizeof taken, "scene read parameters");
    if (status != SONJECT_OK)
        return status;
    status = check_overrides(&context->report, path, overrides, count);
    if (status != SONJECT_OK)
        return status;
    sonject_scene *made;
    status = sonject_scene_create(context, &made);
    if (status != SONJECT_OK)
        return status;
    status = read_file(made, path, overrides, count, taken.allows_user_shapes != 0);
    if (status == SONJECT_OK)
        *scene = made;
    else
        sonject_scene_release(&made);
    return status;
}
