#include <math.h>

#include "scene/shapes/shape.h"

static double extent(const struct shape_size *size, const double v[3])
{
    const double x = size->half_length_m * v[0];
    const double y = size->half_width_m * v[1];
    const double z = size->half_height_m * v[2];
    return sqrt(x * x + y * y + z * z);
}

static void init(struct shape_size *size, const sonject_object_params *object)
{
    const double least = fmin(size->half_length_m, fmin(size->half_width_m, size->half_height_m));
    const double most = fmax(size->half_length_m, fmax(size->half_width_m, size->half_height_m));
    (void)object;
    size->bounding_radius_m = most;
    size->radius_about_nose_m = fmax(size->half_width_m, size->half_height_m);
    size->least_radius_of_curvature_m = least * least / most;
}

const struct shape shape_ellipsoid = {
    .needs = SHAPE_HAS_LENGTH | SHAPE_HAS_WIDTH | SHAPE_HAS_HEIGHT, .init = init, .extent = extent};
