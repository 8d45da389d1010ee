/* A box whose top slants from its height at the tail to the front height at the nose. */
#include <math.h>

#include "scene/shapes/shape.h"

static void check(struct check *check, const sonject_object_params *object)
{
    if (!(object->front_height_m >= 0.0 && object->front_height_m <= object->height_m))
        check_relation(check, "front_height", "height", "must be 0...%g m (the height), not %g",
                       object->height_m, object->front_height_m);
}

static void init(struct shape_size *size, const sonject_object_params *object)
{
    shape_init_box(size, object);
    size->front_height_m = object->front_height_m;
}

static double extent(const struct shape_size *size, const double v[3])
{
    const double x = size->half_length_m;
    const double z = size->half_height_m;
    const double corners[4][2] = {{-x, -z}, {x, -z}, {x, size->front_height_m - z}, {-x, z}};
    double farthest = -INFINITY;
    for (int i = 0; i < 4; i++)
        farthest = fmax(farthest, corners[i][0] * v[0] + corners[i][1] * v[2]);
    return farthest + size->half_width_m * fabs(v[1]);
}

static void record(struct object_record *record, const struct shape_size *size)
{
    const double z = size->half_height_m;
    record_set_slant(record, size->half_length_m, size->front_height_m - z, -size->half_length_m,
                     z);
}

const struct shape shape_wedge = {.needs = SHAPE_HAS_LENGTH | SHAPE_HAS_WIDTH | SHAPE_HAS_HEIGHT,
                                  .may_have = SHAPE_HAS_FRONT_HEIGHT,
                                  .flat = FLAT_ALONG_X | FLAT_ALONG_Y | FLAT_ALONG_Z |
                                          FLAT_WITH_CORNERS,
                                  .check = check,
                                  .init = init,
                                  .extent = extent,
                                  .record = record};
