/* A rectangle, facing up when level. */
#include <math.h>

#include "scene/shapes/shape.h"

static double extent(const struct shape_size *size, const double v[3])
{
    return fabs(size->half_length_m * v[0]) + fabs(size->half_width_m * v[1]);
}

static void init(struct shape_size *size, const sonject_object_params *object)
{
    (void)object;
    size->radius_m = 0.0;
    size->bounding_radius_m = hypot(size->half_length_m, size->half_width_m);
    size->radius_about_nose_m = size->half_width_m;
}

const struct shape shape_plane = {.needs = SHAPE_HAS_LENGTH | SHAPE_HAS_WIDTH,
                                  .flat = FLAT_ALONG_Z | FLAT_WITH_CORNERS,
                                  .init = init,
                                  .extent = extent};
