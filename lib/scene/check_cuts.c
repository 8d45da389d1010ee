#include "scene/check_cuts.h"

#include "base/ranges.h"
#include "scene/shape_size.h"

sonject_status check_cuts_in_scene(const struct scene *scene, const sonject_object_params *object,
                                   struct report *report, struct check_listener *listener)
{
    struct check check = {report, listener, SONJECT_OK};
    struct shape_size size;
    if (object->cut_count == 0)
        return SONJECT_OK;
    shape_size_init(&size, object);
    if (object->shape == SONJECT_SHAPE_MESH && object->mesh < scene->mesh_count)
        shape_size_of_mesh(&size, &scene->meshes[object->mesh]);
    else if (object->shape == SONJECT_SHAPE_USER && object->user_shape < scene->user_shapes.count)
        shape_size_of_user_shape(&size, &scene->user_shapes.shapes[object->user_shape]);
    else
        return SONJECT_OK;
    if (!shape_is_left(&size, object->shape))
        check_failure(&check, "cuts", "leave nothing of the object; move one outwards");
    return check.status;
}
