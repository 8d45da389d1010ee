#include "scene/scene.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

void scene_init(struct scene *scene)
{
    memset(scene, 0, sizeof *scene);
    sonject_sonar_params_init(&scene->sonar);
    sonject_medium_params_init(&scene->medium);
    sonject_seabed_params_init(&scene->seabed);
    sonject_surface_params_init(&scene->surface);
    sonject_geometry_params_init(&scene->geometry);
    sonject_transfer_params_init(&scene->transfer);
    sonject_injection_params_init(&scene->injection);
    sonject_synthetic_params_init(&scene->synthetic);
    scene->patch.struct_size = sizeof scene->patch;
    scene->input_kind = SONJECT_INPUT_MEMORY;
}

void scene_clear(struct scene *scene)
{
    free(scene->input_path);
    free(scene->objects);
    free(scene->water_layers);
    scene_init(scene);
}

/* Room for a power of two of objects, grown when that is full. */
static bool is_full(const struct scene *scene)
{
    return (scene->object_count & (scene->object_count - 1)) == 0;
}

sonject_status scene_append_object(struct scene *scene, struct report *report,
                                   const sonject_object_params *object)
{
    if (scene->object_count >= SCENE_OBJECTS_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "objects must be at most %d, for label images have 8 bits; split "
                              "the scene",
                              SCENE_OBJECTS_MAX);
    if (is_full(scene)) {
        const size_t capacity = scene->object_count == 0 ? 1 : 2 * (size_t)scene->object_count;
        sonject_object_params *objects = realloc(scene->objects, capacity * sizeof *scene->objects);
        if (!objects)
            return report_out_of_memory(report, "objects");
        scene->objects = objects;
    }
    scene->objects[scene->object_count++] = *object;
    return SONJECT_OK;
}

const char *shape_name(uint32_t shape)
{
    switch (shape) {
    case SONJECT_SHAPE_PLANE:
        return "plane";
    case SONJECT_SHAPE_SPHERE:
        return "sphere";
    case SONJECT_SHAPE_CYLINDER:
        return "cylinder";
    case SONJECT_SHAPE_CAPSULE:
        return "capsule";
    case SONJECT_SHAPE_DISC:
        return "disc";
    case SONJECT_SHAPE_ELLIPSOID:
        return "ellipsoid";
    case SONJECT_SHAPE_BOX:
        return "box";
    case SONJECT_SHAPE_WEDGE:
        return "wedge";
    case SONJECT_SHAPE_CONE:
        return "cone";
    case SONJECT_SHAPE_TRUNCATED_CONE:
        return "truncated_cone";
    case SONJECT_SHAPE_TORUS:
        return "torus";
    default:
        return NULL;
    }
}
