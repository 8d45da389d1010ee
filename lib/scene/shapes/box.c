#include <math.h>

#include "scene/shapes/shape.h"

static double extent(const struct shape_size *size, const double v[3])
{
    return fabs(size->half_length_m * v[0]) + fabs(size->half_width_m * v[1]) +
           fabs(size->half_height_m * v[2]);
}

void shape_init_box(struct shape_size *size, const sonject_object_params *object)
{
    (void)object;
    size->radius_about_nose_m = hypot(size->half_width_m, size->half_height_m);
    size->bounding_radius_m =
        hypot(hypot(size->half_length_m, size->half_width_m), size->half_height_m);
}

const struct shape shape_box = {.needs = SHAPE_HAS_LENGTH | SHAPE_HAS_WIDTH | SHAPE_HAS_HEIGHT,
                                .flat =
                                    FLAT_ALONG_X | FLAT_ALONG_Y | FLAT_ALONG_Z | FLAT_WITH_CORNERS,
                                .init = shape_init_box,
                                .extent = extent};
