/* A scene's objects, and the meshes and code that they show. */
#include "api/handles.h"

#include <string.h>

#include "scene/placement.h"
#include "scene/shapes/shape.h"
#include "schema/scene_file.h"

sonject_status sonject_scene_add_mesh(sonject_scene *scene, const char *path,
                                      const sonject_mesh_params *params, uint32_t *mesh)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    if (!path)
        return null_argument(scene->report, "path");
    sonject_mesh_params taken;
    struct mesh_options options;
    sonject_mesh_params_init(&taken);
    mesh_options_init(&options);
    sonject_status status =
        params_take(scene->report, &taken, sizeof taken, params, sizeof taken, "mesh");
    options.unit_m = taken.unit_m;
    options.smooth_angle_rad = taken.smooth_angle_rad;
    for (int axis = 0; axis < 3; axis++)
        options.axes[axis] = taken.axes[axis];
    THEN(status,
         scene_append_mesh(&scene->scene, scene->report, path, &options, taken.allows_open != 0));
    if (status == SONJECT_OK && mesh)
        *mesh = scene->scene.mesh_count - 1;
    return status;
}

sonject_status sonject_scene_add_user_shape(sonject_scene *scene,
                                            const sonject_user_shape_params *shape,
                                            uint32_t *user_shape)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    sonject_user_shape_params taken;
    sonject_user_shape_params_init(&taken);
    sonject_status status =
        params_take(scene->report, &taken, sizeof taken, shape, sizeof taken, "user shape");
    if (status == SONJECT_OK && (!taken.name || !taken.code))
        status = null_argument(scene->report, "name and code of a user shape");
    THEN(status, check_user_shape(&taken, scene->report, NULL));
    THEN(status, user_shapes_append(&scene->scene.user_shapes, scene->report, &taken));
    if (status == SONJECT_OK && user_shape)
        *user_shape = scene->scene.user_shapes.count - 1;
    return status;
}

/* Whether a shape's mesh, or its code, is one of the scene, and its cuts leave something of it. */
static sonject_status check_number(const sonject_scene *scene, const sonject_object_params *shape)
{
    if (shape->shape == SONJECT_SHAPE_USER && shape->user_shape >= scene->scene.user_shapes.count)
        return report_failure(scene->report, SONJECT_ERROR_ARGUMENT,
                              "there is no user shape %lu in the scene",
                              (unsigned long)shape->user_shape);
    if (shape->shape == SONJECT_SHAPE_MESH && shape->mesh >= scene->scene.mesh_count)
        return report_failure(scene->report, SONJECT_ERROR_ARGUMENT,
                              "there is no mesh %lu in the scene", (unsigned long)shape->mesh);
    return check_cuts_in_scene(&scene->scene, shape, scene->report, NULL);
}

sonject_status sonject_scene_add_object(sonject_scene *scene, const sonject_object_params *object,
                                        uint32_t *index)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    sonject_object_params taken;
    sonject_object_params_init(&taken);
    sonject_status status =
        params_take(scene->report, &taken, sizeof taken, object, sizeof taken, "object");
    THEN(status, check_object(&taken, scene->report, NULL));
    THEN(status, check_number(scene, &taken));
    THEN(status, scene_append_object(&scene->scene, scene->report, &taken));
    if (status == SONJECT_OK && index)
        *index = scene->scene.object_count - 1;
    return status;
}

sonject_status sonject_scene_add_target(sonject_scene *scene, const char *path,
                                        const sonject_scene_read_params *params,
                                        const sonject_object_params *object, uint32_t *index)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    if (!path)
        return null_argument(scene->report, "path");
    sonject_scene_read_params reading;
    sonject_object_params placing;
    sonject_scene_read_params_init(&reading);
    sonject_object_params_init(&placing);
    sonject_status status = SONJECT_OK;
    if (params)
        status = params_take(scene->report, &reading, sizeof reading, params, sizeof reading,
                             "scene read parameters");
    if (status == SONJECT_OK && object)
        status =
            params_take(scene->report, &placing, sizeof placing, object, sizeof placing, "object");
    THEN(status, scene_append_target(&scene->scene, scene->report, path,
                                     reading.allows_user_shapes != 0, &placing));
    if (status == SONJECT_OK && index)
        *index = scene->scene.object_count - 1;
    return status;
}

sonject_status sonject_scene_add_part(sonject_scene *scene, uint32_t object,
                                      const sonject_object_params *shape,
                                      const sonject_part_params *part)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    if (object >= scene->scene.object_count)
        return report_failure(scene->report, SONJECT_ERROR_ARGUMENT,
                              "there is no object %lu to add a part to", (unsigned long)object);
    if (scene->scene.objects[object].shape != SONJECT_SHAPE_PARTS)
        return report_failure(scene->report, SONJECT_ERROR_INPUT,
                              "object %lu has a shape of its own; only an object of parts takes "
                              "parts",
                              (unsigned long)object);
    struct scene_part taken;
    sonject_part_params place;
    memset(&taken, 0, sizeof taken);
    sonject_part_params_init(&place);
    sonject_object_params_init(&taken.shape);
    sonject_status status = params_take(scene->report, &taken.shape, sizeof taken.shape, shape,
                                        sizeof taken.shape, "shape");
    THEN(status, params_take(scene->report, &place, sizeof place, part, sizeof place, "part"));
    if (status == SONJECT_OK && taken.shape.shape == SONJECT_SHAPE_PARTS)
        status = report_failure(scene->report, SONJECT_ERROR_INPUT,
                                "shape of a part must be a single one");
    THEN(status, check_object(&taken.shape, scene->report, NULL));
    THEN(status, check_number(scene, &taken.shape));
    THEN(status, check_part(&place, scene->report, NULL));
    if (status != SONJECT_OK)
        return status;
    taken.object = object;
    taken.centre[0] = place.along_m;
    taken.centre[1] = place.across_m;
    taken.centre[2] = place.up_m;
    turn_axes(taken.axes, place.heading_rad, place.pitch_rad, place.roll_rad);
    return scene_append_part(&scene->scene, scene->report, &taken);
}

sonject_status sonject_scene_object_count(const sonject_scene *scene, uint32_t *count)
{
    if (!scene || !count)
        return SONJECT_ERROR_ARGUMENT;
    const struct scene *used;
    CHECK(scene_use(scene->report, scene, &used));
    *count = used->object_count;
    return SONJECT_OK;
}
