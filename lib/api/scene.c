#include "api/handles.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "dataset/campaign.h"
#include "schema/keys.h"
#include "schema/scene_file.h"

sonject_status sonject_scene_create(sonject_context *context, sonject_scene **scene)
{
    BEGIN_MAKING(context, scene);
    *scene = allocate_array(1, sizeof **scene);
    if (!*scene)
        return report_out_of_memory(&context->report, "a scene");
    (*scene)->report = &context->report;
    (*scene)->source.takes_pixels = true;
    scene_init(&(*scene)->scene);
    const sonject_status status = scene_source_keep(&(*scene)->source, &context->report, "scene",
                                                    copy_text("sonject: 1\n"), NULL, 0);
    if (status != SONJECT_OK)
        sonject_scene_release(scene);
    return status;
}

void sonject_scene_release(sonject_scene **scene)
{
    if (!scene || !*scene)
        return;
    scene_clear(&(*scene)->scene);
    mesh_store_clear(&(*scene)->meshes);
    scene_source_clear(&(*scene)->source);
    free(*scene);
    *scene = NULL;
}

sonject_status check_overrides(struct report *report, const char *path,
                               const char *const *overrides, size_t count)
{
    if (!path || (count > 0 && !overrides))
        return null_argument(report, path ? "overrides" : "path, without a text,");
    for (size_t i = 0; i < count; i++)
        if (!overrides[i])
            return null_argument(report, "an override");
    return SONJECT_OK;
}

/* Takes a scene's text and overrides. The text is the file's if none is given. */
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
    return scene_source_keep(source, report, path ? path : "scene", text, params->overrides,
                             params->override_count);
}

sonject_status scene_read_params_take(struct report *report, const char *path,
                                      const sonject_scene_read_params *params,
                                      sonject_scene_read_params *taken)
{
    memset(taken, 0, sizeof *taken);
    if (params)
        CHECK(params_take(report, taken, sizeof *taken, params, sizeof *taken,
                          "scene read parameters"));
    return check_overrides(report, path ? path : taken->text, taken->overrides,
                           taken->override_count);
}

sonject_status sonject_scene_read(sonject_context *context, const char *path,
                                  const sonject_scene_read_params *params, sonject_scene **scene)
{
    sonject_scene_read_params taken;
    BEGIN_MAKING(context, scene);
    struct report *report = &context->report;
    CHECK(scene_read_params_take(report, path, params, &taken));
    sonject_scene *made = allocate_array(1, sizeof *made);
    CHECK_MEMORY(report, made, "a scene");
    made->report = report;
    scene_init(&made->scene);
    sonject_status status = take_source(report, path, &taken, &made->source);
    THEN(status, scene_source_read(&made->source, report, &made->scene));
    made->is_read = true;
    if (status == SONJECT_OK)
        *scene = made;
    else
        sonject_scene_release(&made);
    return status;
}

sonject_status sonject_scene_bands(sonject_context *context, const char *path,
                                   const sonject_scene_read_params *params, char **names)
{
    struct scene_source source;
    sonject_scene_read_params taken;
    BEGIN_MAKING(context, names);
    CHECK(scene_read_params_take(&context->report, path, params, &taken));
    memset(&source, 0, sizeof source);
    sonject_status status = take_source(&context->report, path, &taken, &source);
    THEN(status, scene_source_bands(&source, &context->report, names));
    scene_source_clear(&source);
    return status;
}

sonject_status scene_use(struct report *report, const sonject_scene *handle,
                         const struct scene **scene)
{
    struct sonject_scene *used = (struct sonject_scene *)handle; /* its contents stay the same */
    if (!used)
        return null_argument(report, "scene");
    if (!used->is_read) {
        scene_clear(&used->scene); /* the scene before, whose meshes go to the store */
        used->scene.mesh_store = &used->meshes;
        CHECK(scene_source_read(&used->source, report, &used->scene));
        mesh_store_clear(&used->meshes);
    }
    used->is_read = true;
    *scene = &used->scene;
    return SONJECT_OK;
}

/* Checks that there is a text to read and change. arguments: names of what must not be NULL. */
static sonject_status begin_text(sonject_scene *scene, bool has_arguments, const char *arguments)
{
    scene->report->message[0] = '\0';
    if (!has_arguments)
        return null_argument(scene->report, arguments);
    if (!scene->source.text)
        return report_failure(
            scene->report, SONJECT_ERROR_ARGUMENT,
            "a campaign's scene has no text: read and set keys of its scene file");
    return SONJECT_OK;
}

sonject_status sonject_scene_set(sonject_scene *scene, const char *key, const char *value)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    CHECK(begin_text(scene, key && value, "key and value"));
    CHECK(scene_source_set(&scene->source, scene->report, key, value));
    scene->is_read = false;
    return SONJECT_OK;
}

sonject_status sonject_scene_set_table(sonject_scene *scene, const char *key, const char *columns,
                                       const double *values, size_t row_count, size_t column_count)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    CHECK(begin_text(scene, key && values, "key and values"));
    const struct number_array array = {(char *)key, (char *)columns, (double *)values, row_count,
                                       column_count};
    CHECK(scene_source_set_array(&scene->source, scene->report, &array));
    scene->is_read = false;
    return SONJECT_OK;
}

sonject_status sonject_scene_get(const sonject_scene *scene, const char *key, char **json)
{
    if (json)
        *json = NULL;
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    CHECK(begin_text((sonject_scene *)scene, key && json, "key and json"));
    return scene_source_get(&((sonject_scene *)scene)->source, scene->report, key, json);
}

sonject_status sonject_scene_text(const sonject_scene *scene, char **text)
{
    if (text)
        *text = NULL;
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    CHECK(begin_text((sonject_scene *)scene, text != NULL, "text"));
    return scene_source_text(&((sonject_scene *)scene)->source, scene->report, text);
}

sonject_status sonject_keys(sonject_context *context, uint32_t of, char **json)
{
    BEGIN_MAKING(context, json);
    if (of > SONJECT_KEYS_OF_CAMPAIGNS)
        return report_failure(&context->report, SONJECT_ERROR_ARGUMENT,
                              "keys are those of scenes (%d) or campaigns (%d), not %u",
                              SONJECT_KEYS_OF_SCENES, SONJECT_KEYS_OF_CAMPAIGNS, (unsigned)of);
    return section_keys_json(
        &context->report, of == SONJECT_KEYS_OF_SCENES ? &scene_section : &campaign_section, json);
}

sonject_status sonject_scene_object_count(const sonject_scene *scene, uint32_t *count)
{
    const struct scene *used;
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    scene->report->message[0] = '\0';
    if (!count)
        return null_argument(scene->report, "count");
    CHECK(scene_use(scene->report, scene, &used));
    *count = used->object_count;
    return SONJECT_OK;
}

/* Makes a scene that has the options, so that they mean what they mean in scenes. */
sonject_status image_options_take(struct report *report, const char *channel, const char *array,
                                  const char *transfer, const char *geometry,
                                  struct image_options *options)
{
    static const char text[] =
        "sonject: 1\nsonar: {frequency: 1e5, bandwidth: 1e4, altitude: 1}\ninput: {path: image, "
        "geometry: {row_spacing: 1, column_spacing: 1, first_slant_range: 1}}\n";
    const char *const keys[] = {"input.channel", "input.transfer", "input.geometry"};
    const char *const values[] = {channel, transfer, geometry};
    struct scene_source source;
    struct scene scene;
    memset(&source, 0, sizeof source);
    scene_init(&scene);
    sonject_status status = scene_source_keep(&source, report, "options", copy_text(text), NULL, 0);
    for (int i = 0; i < 3; i++)
        if (values[i])
            THEN(status, scene_source_set(&source, report, keys[i], values[i]));
    THEN(status, scene_source_read(&source, report, &scene));
    *options = (struct image_options){scene.channel, array, scene.transfer, geometry != NULL,
                                      scene.geometry};
    scene_clear(&scene);
    scene_source_clear(&source);
    return status;
}
