/* Code of a user's, of which a box and a sphere that hold it are known. */
#include <math.h>

#include "scene/shapes/shape.h"

void shape_size_of_user_shape(struct shape_size *size, const struct user_shape *shape)
{
    size->user_shape = shape;
    size->half_length_m = shape->half_length_m;
    size->half_width_m = shape->half_width_m;
    size->half_height_m = shape->half_height_m;
    size->bounding_radius_m = (1.0 + 1e-6) * shape->bounding_radius_m;
    size->radius_about_nose_m =
        fmin(hypot(size->half_width_m, size->half_height_m), size->bounding_radius_m);
}

static struct shape_size sphere_about(const struct shape_size *size)
{
    struct shape_size sphere = *size;
    sphere.radius_m = size->user_shape->bounding_radius_m;
    return sphere;
}

static double extent(const struct shape_size *size, const double v[3])
{
    const struct shape_size sphere = sphere_about(size);
    return fmin(shape_extent(size, SONJECT_SHAPE_BOX, v),
                shape_extent(&sphere, SONJECT_SHAPE_SPHERE, v));
}

static bool is_left(const struct shape_size *size)
{
    const struct shape_size sphere = sphere_about(size);
    return shape_is_left(size, SONJECT_SHAPE_BOX) && shape_is_left(&sphere, SONJECT_SHAPE_SPHERE);
}

const struct shape shape_user = {.name = "user",
                                 .needs = SHAPE_HAS_CODE,
                                 .kind = SHAPE_USER,
                                 .extent = extent,
                                 .cut_extent = extent,
                                 .is_left = is_left};
