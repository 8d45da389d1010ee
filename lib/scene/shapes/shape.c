/* The functions that all shapes have in common. */
#include "scene/shapes/shape.h"

#include <math.h>
#include <string.h>

const struct shape_key_name shape_keys[] = {
    {"length", SHAPE_HAS_LENGTH},
    {"width", SHAPE_HAS_WIDTH},
    {"diameter", SHAPE_HAS_DIAMETER},
    {"height", SHAPE_HAS_HEIGHT},
    {"top_diameter", SHAPE_HAS_TOP_DIAMETER},
    {"front_height", SHAPE_HAS_FRONT_HEIGHT},
    {"nose_end", SHAPE_HAS_ENDS},
    {"tail_end", SHAPE_HAS_ENDS},
    {"mesh", SHAPE_HAS_MESH},
    {NULL, 0},
};

static const struct shape shape_parts = {.needs = 0};

static const struct {
    const char *name;
    const struct shape *row;
    int traits;
} shapes[] = {
#define SHAPE_ROW(NUMBER, name, traits) [SHAPE_##NUMBER] = {#name, &shape_##name, traits},
    ALL_SHAPES(SHAPE_ROW)[SHAPE_PARTS] = {"parts", &shape_parts, 0}};

const struct shape *shape_of(uint32_t shape)
{
    return shape < sizeof shapes / sizeof *shapes ? shapes[shape].row : NULL;
}

const char *shape_name(uint32_t shape)
{
    return shape < sizeof shapes / sizeof *shapes ? shapes[shape].name : NULL;
}

void shape_size_init(struct shape_size *size, const sonject_object_params *object)
{
    const struct shape *shape = shape_of(object->shape);
    memset(size, 0, sizeof *size);
    size->half_length_m = 0.5 * object->length_m;
    size->half_width_m = 0.5 * object->width_m;
    size->half_height_m = 0.5 * object->height_m;
    size->radius_m = 0.5 * object->diameter_m;
    size->bounding_radius_m = size->radius_about_nose_m = size->radius_m;
    size->least_radius_of_curvature_m = INFINITY;
    size->flat = shape->flat;
    if (shape->init)
        shape->init(size, object);
    size->bounding_radius_m *= 1.0 + 1e-6; /* margin for rounding to single precision */
}

void shape_size_init_in_scene(struct shape_size *size, const struct scene *scene,
                              const sonject_object_params *object)
{
    shape_size_init(size, object);
    if (object->shape == SHAPE_MESH)
        shape_size_of_mesh(size, &scene->meshes[object->mesh]);
}

bool shape_is_convex(const struct shape_size *size, uint32_t shape)
{
    return !(shapes[shape].traits & SHAPE_IS_HOLLOW) && !size->nose.is_open && !size->tail.is_open;
}

double shape_extent(const struct shape_size *size, uint32_t shape, const double v[3])
{
    return shape_of(shape)->extent(size, v);
}

void record_set_slant(struct object_record *record, double across, double up, double to_across,
                      double to_up)
{
    const double length = hypot(to_across - across, to_up - up);
    const double normal_across = (to_up - up) / length;
    const double normal_up = (across - to_across) / length;
    record->slant_across = (float)normal_across;
    record->slant_up = (float)normal_up;
    record->slant_offset = (float)(normal_across * across + normal_up * up);
}

void shape_record_init(struct object_record *record, const struct shape_size *size, uint32_t shape)
{
    const struct shape *row = shape_of(shape);
    record->shape = (int32_t)shape;
    record->half_length = (float)size->half_length_m;
    record->half_width = (float)size->half_width_m;
    record->half_height = (float)size->half_height_m;
    record->radius = (float)size->radius_m;
    record->ring_radius = (float)size->ring_radius_m;
    record->bounding_radius = (float)size->bounding_radius_m;
    if (row->record)
        row->record(record, size);
}

void check_shape(struct check *check, const sonject_object_params *object)
{
    const struct shape *shape = shape_of(object->shape);
    if (shape->check)
        shape->check(check, object);
}
