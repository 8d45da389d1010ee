/* A cylinder along the nose, whose ends are flat, open or parts of spheres. */
#include <math.h>

#include "scene/shapes/shape.h"

static void check_end(struct check *check, const sonject_object_params *object, const char *key,
                      double depth_m)
{
    if (!(depth_m >= 0.0 && depth_m <= 0.5 * object->diameter_m))
        check_relation(check, key, "diameter", "must be 0...%g m (half the diameter), not %g",
                       0.5 * object->diameter_m, depth_m);
}

static void check(struct check *check, const sonject_object_params *object)
{
    struct shape_size size;
    check_end(check, object, "nose_end.depth", object->nose_end_depth_m);
    check_end(check, object, "tail_end.depth", object->tail_end_depth_m);
    shape_size_init(&size, object);
    const double ends = size.nose.depth_m + size.tail.depth_m;
    if (object->length_m < ends)
        check_relation(check, "length", "diameter nose_end tail_end",
                       "of a cylinder includes its spherical ends and must be at least their %g m, "
                       "not %g m",
                       ends, object->length_m);
}

static void set_end(struct end_size *end, const sonject_object_params *object, uint32_t kind,
                    double depth_m)
{
    end->is_open = kind == SONJECT_END_OPEN;
    end->depth_m = 0.0;
    if (kind == SONJECT_END_SPHERICAL)
        end->depth_m = depth_m > 0.0 ? depth_m : 0.5 * object->diameter_m;
    end->joint_m = 0.5 * object->length_m - end->depth_m;
}

static void init(struct shape_size *size, const sonject_object_params *object)
{
    set_end(&size->nose, object, object->nose_end, object->nose_end_depth_m);
    set_end(&size->tail, object, object->tail_end, object->tail_end_depth_m);
    size->bounding_radius_m =
        fmax(size->half_length_m, /* tips or rims */
             hypot(fmax(size->nose.joint_m, size->tail.joint_m), size->radius_m));
    size->least_radius_of_curvature_m = size->radius_m;
    if (size->nose.depth_m > 0.0 && size->tail.depth_m > 0.0)
        size->flat = 0;
}

static double end_extent(const struct end_size *end, double radius, double outward, double along,
                         double across)
{
    const double v = outward * along;
    if (end->depth_m > 0.0) {
        const double sphere = (radius * radius / end->depth_m + end->depth_m) / 2.0;
        const double centre = end->joint_m + end->depth_m - sphere;
        const double length = hypot(along, across);
        if (v * sphere >= length * (sphere - end->depth_m)) /* the normal meets the round end */
            return centre * v + sphere * length;
    }
    return end->joint_m * v + radius * across;
}

static double extent(const struct shape_size *size, const double v[3])
{
    const double about_nose = hypot(v[1], v[2]);
    return fmax(end_extent(&size->nose, size->radius_m, 1.0, v[0], about_nose),
                end_extent(&size->tail, size->radius_m, -1.0, v[0], about_nose));
}

static void end_record_init(struct end_record *record, const struct end_size *end, double radius)
{
    record->joint = (float)end->joint_m;
    record->depth = (float)end->depth_m;
    record->curvature =
        (float)(2.0 * end->depth_m / (radius * radius + end->depth_m * end->depth_m));
    record->is_open = end->is_open;
}

static void record(struct object_record *record, const struct shape_size *size)
{
    if (size->nose.is_open || size->tail.is_open)
        record->shape = SHAPE_OPEN_CYLINDER;
    else if (size->nose.depth_m > 0.0 || size->tail.depth_m > 0.0)
        record->shape = SHAPE_ENDED_CYLINDER;
    end_record_init(&record->ends[END_NOSE], &size->nose, size->radius_m);
    end_record_init(&record->ends[END_TAIL], &size->tail, size->radius_m);
}

const struct shape shape_cylinder = {.needs = SHAPE_HAS_LENGTH | SHAPE_HAS_DIAMETER,
                                     .may_have = SHAPE_HAS_ENDS,
                                     .flat = FLAT_ALONG_X,
                                     .check = check,
                                     .init = init,
                                     .extent = extent,
                                     .record = record};
