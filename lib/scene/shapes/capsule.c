/* A cylinder along the nose with half spheres at its ends. */
#include <math.h>

#include "scene/shapes/shape.h"

static void check(struct check *check, const sonject_object_params *object)
{
    if (object->length_m < object->diameter_m)
        check_relation(
            check, "length", "diameter",
            "of a capsule includes its round ends and must be at least its diameter, %g m, not "
            "%g m",
            object->diameter_m, object->length_m);
}

static void init(struct shape_size *size, const sonject_object_params *object)
{
    (void)object;
    size->half_length_m -= size->radius_m;
    size->bounding_radius_m = size->half_length_m + size->radius_m;
    size->least_radius_of_curvature_m = size->radius_m;
}

static double extent(const struct shape_size *size, const double v[3])
{
    return fabs(size->half_length_m * v[0]) +
           size->radius_m * sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

const struct shape shape_capsule = {
    .needs = SHAPE_HAS_LENGTH | SHAPE_HAS_DIAMETER, .check = check, .init = init, .extent = extent};
