/* Cones, tip up when level, and truncated ones. */
#include <math.h>

#include "scene/shapes/shape.h"

static double extent(const struct shape_size *size, const double v[3])
{
    const double level = hypot(v[0], v[1]);
    const double z = size->half_height_m * v[2];
    return fmax(size->radius_m * level - z, size->top_radius_m * level + z);
}

static void record(struct object_record *record, const struct shape_size *size)
{
    const double z = size->half_height_m;
    record->shape = SHAPE_CONE;
    record_set_slant(record, size->radius_m, -z, size->top_radius_m, z);
    record->radius = (float)fmax(size->radius_m, size->top_radius_m);
}

static void init(struct shape_size *size, const sonject_object_params *object)
{
    if (object->shape == SHAPE_TRUNCATED_CONE)
        size->top_radius_m = 0.5 * object->top_diameter_m;
    size->bounding_radius_m = hypot(fmax(size->radius_m, size->top_radius_m), size->half_height_m);
    size->radius_about_nose_m = size->bounding_radius_m;
    size->least_radius_of_curvature_m = fmax(size->top_radius_m, 0.5 * size->radius_m);
}

const struct shape shape_cone = {.needs = SHAPE_HAS_DIAMETER | SHAPE_HAS_HEIGHT,
                                 .flat = FLAT_ALONG_Z,
                                 .init = init,
                                 .extent = extent,
                                 .record = record};
const struct shape shape_truncated_cone = {.needs = SHAPE_HAS_DIAMETER | SHAPE_HAS_HEIGHT |
                                                    SHAPE_HAS_TOP_DIAMETER,
                                           .flat = FLAT_ALONG_Z,
                                           .init = init,
                                           .extent = extent,
                                           .record = record};
