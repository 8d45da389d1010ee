#include "trace/object_shape.h"

#include <math.h>

static int32_t kind_of(const struct shape_size *size, uint32_t shape)
{
    static const int32_t kinds[] = {
        [SONJECT_SHAPE_PLANE] = SHAPE_PLANE,       [SONJECT_SHAPE_SPHERE] = SHAPE_SPHERE,
        [SONJECT_SHAPE_CYLINDER] = SHAPE_CYLINDER, [SONJECT_SHAPE_CAPSULE] = SHAPE_CAPSULE,
        [SONJECT_SHAPE_DISC] = SHAPE_DISC,         [SONJECT_SHAPE_ELLIPSOID] = SHAPE_ELLIPSOID,
        [SONJECT_SHAPE_BOX] = SHAPE_BOX,           [SONJECT_SHAPE_WEDGE] = SHAPE_WEDGE,
        [SONJECT_SHAPE_CONE] = SHAPE_CONE,         [SONJECT_SHAPE_TRUNCATED_CONE] = SHAPE_CONE,
        [SONJECT_SHAPE_TORUS] = SHAPE_TORUS,       [SONJECT_SHAPE_MESH] = SHAPE_MESH,
        [SONJECT_SHAPE_USER] = SHAPE_USER,
    };
    if (shape != SONJECT_SHAPE_CYLINDER)
        return kinds[shape];
    if (size->nose.is_open || size->tail.is_open)
        return SHAPE_OPEN_CYLINDER;
    return size->nose.depth_m > 0.0 || size->tail.depth_m > 0.0 ? SHAPE_ENDED_CYLINDER
                                                                : SHAPE_CYLINDER;
}

/* The face through two points of a profile, (across, up), seen from the left of the way between. */
static void lay_slant(struct object_record *record, double across, double up, double to_across,
                      double to_up)
{
    const double length = hypot(to_across - across, to_up - up);
    const double normal_across = (to_up - up) / length;
    const double normal_up = (across - to_across) / length;
    record->slant_across = (float)normal_across;
    record->slant_up = (float)normal_up;
    record->slant_offset = (float)(normal_across * across + normal_up * up);
}

static void end_record_init(struct end_record *record, const struct end_size *end, double radius)
{
    record->joint = (float)end->joint_m;
    record->depth = (float)end->depth_m;
    record->curvature =
        (float)(2.0 * end->depth_m / (radius * radius + end->depth_m * end->depth_m));
    record->is_open = end->is_open;
}

void object_shape_init(struct object_record *record, const struct shape_size *size, uint32_t shape)
{
    const double z = size->half_height_m;
    record->shape = kind_of(size, shape);
    record->half_length = (float)size->half_length_m;
    record->half_width = (float)size->half_width_m;
    record->half_height = (float)size->half_height_m;
    record->radius = (float)size->radius_m;
    record->ring_radius = (float)size->ring_radius_m;
    record->bounding_radius = (float)size->bounding_radius_m;
    if (record->shape == SHAPE_CONE) {
        lay_slant(record, size->radius_m, -z, size->top_radius_m, z);
        record->radius = (float)fmax(size->radius_m, size->top_radius_m);
    } else if (record->shape == SHAPE_WEDGE) {
        lay_slant(record, size->half_length_m, size->front_height_m - z, -size->half_length_m, z);
    }
    if (shape == SONJECT_SHAPE_CYLINDER) {
        end_record_init(&record->ends[END_NOSE], &size->nose, size->radius_m);
        end_record_init(&record->ends[END_TAIL], &size->tail, size->radius_m);
    }
    record->cuts = (int32_t)size->cut_count;
    for (uint32_t i = 0; i < size->cut_count; i++) {
        record->cut[i].normal_x = (float)size->cuts[i].normal[0];
        record->cut[i].normal_y = (float)size->cuts[i].normal[1];
        record->cut[i].normal_z = (float)size->cuts[i].normal[2];
        record->cut[i].offset = (float)size->cuts[i].offset_m;
    }
}

typedef char cuts_are_as_many[OBJECT_CUTS == SONJECT_CUTS_CAPACITY ? 1 : -1];
