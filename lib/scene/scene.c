#include "scene/scene.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/result.h>

#include "base/memory.h"

#define PI 3.14159265358979323846

static void give_up_mesh(struct scene *scene, struct mesh *mesh)
{
    if (scene->mesh_store)
        mesh_store_give(scene->mesh_store, mesh);
    else
        mesh_clear(mesh);
}

void scene_clear(struct scene *scene)
{
    free(scene->input_path);
    ping_table_clear(&scene->pings);
    free(scene->array);
    free(scene->calibration);
    free(scene->calibrated);
    free(scene->first_returns.columns);
    free(scene->band);
    free(scene->bands);
    free(scene->objects);
    free(scene->parts);
    for (uint32_t i = 0; i < scene->mesh_count; i++)
        give_up_mesh(scene, &scene->meshes[i]);
    free(scene->meshes);
    free(scene->water_layers);
    response_table_clear(&scene->pulse_table);
    response_table_clear(&scene->cross_range_table);
    aperture_motion_clear(&scene->motion);
    relief_features_clear(&scene->relief);
    for (size_t i = 0; i < scene->written.count; i++)
        free(scene->written.keys[i].path);
    free(scene->written.keys);
    memset(scene, 0, sizeof *scene);
}

sonject_status scene_append_object(struct scene *scene, struct report *report,
                                   const sonject_object_params *object)
{
    sonject_object_params *objects =
        grow_doubling(scene->objects, scene->object_count, sizeof *objects);
    CHECK_MEMORY(report, objects, "objects");
    scene->objects = objects;
    sonject_object_params *own = &scene->objects[scene->object_count++];
    *own = *object;
    if (!own->name[0])
        snprintf(own->name, sizeof own->name, "object %u", (unsigned)scene->object_count);
    if (!own->class_name[0] && shape_name(own->shape))
        snprintf(own->class_name, sizeof own->class_name, "%s", shape_name(own->shape));
    return SONJECT_OK;
}

sonject_status scene_append_part(struct scene *scene, struct report *report,
                                 const struct scene_part *part)
{
    struct scene_part *parts = grow_doubling(scene->parts, scene->part_count, sizeof *parts);
    CHECK_MEMORY(report, parts, "parts");
    scene->parts = parts;
    scene->parts[scene->part_count++] = *part;
    return SONJECT_OK;
}

static sonject_status append_mesh(struct scene *scene, struct report *report, const char *path,
                                  const struct mesh_options *options, bool allows_open)
{
    struct path_facts file;
    if (scene->mesh_count >= SCENE_MESHES_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "meshes must be at most %d in a scene; split it", SCENE_MESHES_MAX);
    struct mesh *meshes = grow_doubling(scene->meshes, scene->mesh_count, sizeof *meshes);
    CHECK_MEMORY(report, meshes, "meshes");
    scene->meshes = meshes;
    struct mesh *mesh = &scene->meshes[scene->mesh_count];
    CHECK(scene->mesh_store ? file_identify(report, path, &file) : SONJECT_OK);
    if (!scene->mesh_store || !mesh_store_take(scene->mesh_store, &file, options, mesh))
        CHECK(mesh_load(report, path, options, mesh));
    const sonject_status status =
        allows_open ? SONJECT_OK : mesh_require_closed(report, path, mesh);
    if (status == SONJECT_OK)
        scene->mesh_count++;
    else
        mesh_clear(mesh);
    return status;
}

sonject_status scene_share_mesh(struct scene *scene, struct report *report, const char *path,
                                const struct mesh_options *options, bool allows_open,
                                uint32_t *number)
{
    struct path_facts file;
    CHECK(file_identify(report, path, &file));
    for (*number = 0; *number < scene->mesh_count; ++*number)
        if (mesh_is_of(&scene->meshes[*number], &file, options))
            return allows_open ? SONJECT_OK
                               : mesh_require_closed(report, path, &scene->meshes[*number]);
    return append_mesh(scene, report, path, options, allows_open);
}

sonject_status scene_note_key(struct scene *scene, struct report *report, const char *path,
                              const char *place)
{
    const size_t path_bytes = strlen(path) + 1;
    const size_t place_bytes = strlen(place) + 1;
    struct written_keys *written = &scene->written;
    struct written_key *keys = grow_doubling(written->keys, written->count, sizeof *keys);
    CHECK_MEMORY(report, keys, "a scene's keys");
    written->keys = keys;
    struct written_key *key = &keys[written->count];
    key->path = malloc(path_bytes + place_bytes);
    CHECK_MEMORY(report, key->path, "a scene's keys");
    memcpy(key->path, path, path_bytes);
    key->place = memcpy(key->path + path_bytes, place, place_bytes);
    written->count++;
    return SONJECT_OK;
}

uint32_t scene_key_source(const struct scene *scene, const char *path)
{
    const size_t length = strlen(path);
    const char *line = scene->calibrated;
    while (line && *line) {
        if (strncmp(line, path, length) == 0 && line[length] == '\n')
            return SONJECT_SOURCE_CALIBRATION;
        line += strcspn(line, "\n") + 1;
    }
    for (size_t i = 0; i < scene->written.count; i++)
        if (strcmp(scene->written.keys[i].path, path) == 0)
            return SONJECT_SOURCE_SCENE;
    return SONJECT_SOURCE_DEFAULT;
}

/* Shortens a path to the section around it, and at last to "". */
static void go_out(char *path)
{
    char *dot = strrchr(path, '.');
    *(dot ? dot : path) = '\0';
}

sonject_status scene_locate(const struct scene *scene, struct report *report, sonject_status status,
                            const char *path, ...)
{
    char name[128], message[REPORT_LINE];
    va_list arguments;
    va_start(arguments, path);
    vsnprintf(name, sizeof name, path, arguments);
    va_end(arguments);
    if (status != SONJECT_ERROR_INPUT)
        return status;
    snprintf(message, sizeof message, "%.*s", REPORT_LINE - 1, report->message);
    for (; *name; go_out(name))
        for (size_t i = 0; i < scene->written.count; i++) {
            const struct written_key *key = &scene->written.keys[i];
            const char *told = strrchr(key->place, ' '); /* the key path after "--set " or "set " */
            const bool is_told = told && strcmp(told + 1, name) == 0;
            if (strcmp(key->path, name) == 0)
                return report_failure(report, status, "%s%s%s: %s", key->place, is_told ? "" : ": ",
                                      is_told ? "" : name, message);
        }
    return status;
}

sonject_material_params surface_material(const sonject_surface_params *surface)
{
    sonject_material_params material = surface->material;
    const double most = material.reflection_kind == SONJECT_REFLECTION_FLUID
                            ? 1.0
                            : material.reflection * material.reflection;
    if (isnan(material.glossy_albedo))
        material.glossy_albedo = fmax(0.0, most - PI * material.lambert);
    return material;
}
