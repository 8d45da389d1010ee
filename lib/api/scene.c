#include "api/handles.h"

#include <stddef.h>
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
    (*scene)->is_read = true; /* the defaults, until something is set */
    (*scene)->source.takes_pixels = true;
    scene_init(&(*scene)->scene);
    return SONJECT_OK;
}

void sonject_scene_release(sonject_scene **scene)
{
    if (!scene || !*scene)
        return;
    scene_clear(&(*scene)->scene);
    scene_source_clear(&(*scene)->source);
    free(*scene);
    *scene = NULL;
}

sonject_status check_overrides(struct report *report, const char *path,
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
    const struct scene_text source = {.path = path,
                                      .text = text,
                                      .bytes = bytes,
                                      .overrides = overrides,
                                      .override_count = count};
    status = scene_text_bands(report, &source, names);
    free(text);
    return status;
}

void sonject_scene_read_params_init(sonject_scene_read_params *params)
{
    memset(params, 0, sizeof *params);
    params->struct_size = sizeof *params;
}

/* Text and overrides of a scene, from its file where no text is given. */
static sonject_status take_source(struct report *report, const char *path,
                                  const sonject_scene_read_params *params,
                                  struct scene_source *source)
{
    size_t bytes;
    char *text = params->text ? copy_text(params->text) : NULL;
    if (params->text)
        CHECK_MEMORY(report, text, "a scene");
    else
        CHECK(scene_file_load(report, path, &text, &bytes));
    source->takes_pixels = params->text != NULL;
    source->allows_user_shapes = params->allows_user_shapes != 0;
    return scene_source_keep(source, report, path ? path : "scene", text, params->overrides,
                             params->override_count);
}

sonject_status sonject_scene_read(sonject_context *context, const char *path,
                                  const sonject_scene_read_params *params, sonject_scene **scene)
{
    if (!context || !scene)
        return SONJECT_ERROR_ARGUMENT;
    *scene = NULL;
    context_begin_call(context);
    struct report *report = &context->report;
    sonject_scene_read_params taken = {.struct_size = sizeof taken};
    sonject_scene *made;
    if (params)
        CHECK(params_take(report, &taken, sizeof taken, params,
                          offsetof(sonject_scene_read_params, text), "scene read parameters"));
    CHECK(check_overrides(report, path ? path : taken.text, taken.overrides, taken.override_count));
    CHECK(sonject_scene_create(context, &made));
    sonject_status status = take_source(report, path, &taken, &made->source);
    THEN(status, scene_source_read(&made->source, report, &made->scene));
    if (status == SONJECT_OK)
        *scene = made;
    else
        sonject_scene_release(&made);
    return status;
}

sonject_status sonject_scene_read_with(sonject_context *context, const char *path,
                                       const char *const *overrides, size_t count,
                                       const sonject_scene_read_params *params,
                                       sonject_scene **scene)
{
    sonject_scene_read_params all = {.struct_size = sizeof all};
    all.allows_user_shapes = params ? params->allows_user_shapes : 0;
    all.overrides = overrides;
    all.override_count = (uint32_t)count;
    return sonject_scene_read(context, path, &all, scene);
}

sonject_status scene_use(struct report *report, const sonject_scene *handle,
                         const struct scene **scene)
{
    struct sonject_scene *used = (struct sonject_scene *)handle; /* what it says stays the same */
    if (!used)
        return null_argument(report, "scene");
    if (!used->is_read) {
        scene_clear(&used->scene);
        CHECK(scene_source_read(&used->source, report, &used->scene));
    }
    used->is_read = true;
    *scene = &used->scene;
    return SONJECT_OK;
}

/* Whether there is a text that can be changed. */
static sonject_status begin_setting(sonject_scene *scene, bool has_arguments)
{
    scene->report->message[0] = '\0';
    if (!has_arguments)
        return null_argument(scene->report, "key and value");
    if (!scene->source.text && scene->source.takes_pixels) /* created, and empty so far */
        return scene_source_keep(&scene->source, scene->report, "scene", copy_text("sonject: 1\n"),
                                 NULL, 0);
    if (!scene->source.text)
        return report_failure(scene->report, SONJECT_ERROR_ARGUMENT,
                              "a campaign's scene stays as it is: set keys of its scene file");
    return SONJECT_OK;
}

sonject_status sonject_scene_set(sonject_scene *scene, const char *key, const char *value)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    CHECK(begin_setting(scene, key && value));
    CHECK(scene_source_set(&scene->source, scene->report, key, value));
    scene->is_read = false;
    return SONJECT_OK;
}

sonject_status sonject_scene_set_table(sonject_scene *scene, const char *key, const char *columns,
                                       const double *values, size_t row_count, size_t column_count)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    CHECK(begin_setting(scene, key && values));
    const struct number_array array = {(char *)key, (char *)columns, (double *)values, row_count,
                                       column_count};
    CHECK(scene_source_set_array(&scene->source, scene->report, &array));
    scene->is_read = false;
    return SONJECT_OK;
}

sonject_status sonject_scene_text(const sonject_scene *scene, char **text)
{
    if (!scene || !text)
        return SONJECT_ERROR_ARGUMENT;
    *text = NULL;
    CHECK(begin_setting((sonject_scene *)scene, true));
    return scene_source_text(&((sonject_scene *)scene)->source, scene->report, text);
}

sonject_status sonject_keys(sonject_context *context, char **json)
{
    if (!context || !json)
        return SONJECT_ERROR_ARGUMENT;
    *json = NULL;
    context_begin_call(context);
    return scene_keys_json(&context->report, json);
}
