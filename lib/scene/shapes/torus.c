/* A ring, lying flat when level. */
#include <math.h>

#include "scene/shapes/shape.h"

static void check(struct check *check, const sonject_object_params *object)
{
    if (object->diameter_m <= 2.0 * object->height_m)
        check_relation(check, "diameter", "height",
                       "of a torus is that of its outline and must be above twice its height, %g "
                       "m, or there is no hole; it is %g m",
                       2.0 * object->height_m, object->diameter_m);
}

static void init(struct shape_size *size, const sonject_object_params *object)
{
    (void)object;
    size->ring_radius_m = size->half_height_m;
    size->radius_m -= size->ring_radius_m;
    size->bounding_radius_m = size->radius_m + size->ring_radius_m;
    size->radius_about_nose_m = size->bounding_radius_m;
    /* radii of the ring's section and of the hole's waist */
    size->least_radius_of_curvature_m =
        fmin(size->ring_radius_m, size->radius_m - size->ring_radius_m);
}

static double extent(const struct shape_size *size, const double v[3])
{
    return size->radius_m * hypot(v[0], v[1]) +
           size->ring_radius_m * sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

const struct shape shape_torus = {
    .needs = SHAPE_HAS_DIAMETER | SHAPE_HAS_HEIGHT, .check = check, .init = init, .extent = extent};
