/* A disc, facing up when level. */
#include <math.h>

#include "scene/shapes/shape.h"

static double extent(const struct shape_size *size, const double v[3])
{
    return size->radius_m * hypot(v[0], v[1]);
}

const struct shape shape_disc = {
    .needs = SHAPE_HAS_DIAMETER, .flat = FLAT_ALONG_Z, .extent = extent};
