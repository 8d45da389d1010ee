#include <math.h>

#include "scene/shapes/shape.h"

static void init(struct shape_size *size, const sonject_object_params *object)
{
    (void)object;
    size->half_length_m = 0.0;
    size->least_radius_of_curvature_m = size->radius_m;
}

static double extent(const struct shape_size *size, const double v[3])
{
    return size->radius_m * sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

const struct shape shape_sphere = {.needs = SHAPE_HAS_DIAMETER, .init = init, .extent = extent};
