/* What all shapes have in common. With cuts, support functions follow by duality: of a convex shape
 * within n . p <= c the largest p . v is the least of h(v - t n) + t c over t >= 0, h the shape's
 * own. */
#include "scene/shapes/shape.h"

#include <math.h>
#include <string.h>

#define GOLDEN 0.61803398874989485
#define STEPS  90

typedef char cuts_are_as_many[OBJECT_CUTS == SONJECT_CUTS_CAPACITY ? 1 : -1];

const struct shape_key_name shape_keys[] = {
    {"length", SHAPE_HAS_LENGTH},
    {"width", SHAPE_HAS_WIDTH},
    {"diameter", SHAPE_HAS_DIAMETER},
    {"height", SHAPE_HAS_HEIGHT},
    {"user", SHAPE_HAS_CODE},
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

static void set_cuts(struct shape_size *size, const sonject_object_params *object)
{
    size->cut_count = object->cut_count;
    for (uint32_t i = 0; i < object->cut_count; i++) {
        const sonject_cut *cut = &object->cuts[i];
        struct cut_plane *plane = &size->cuts[i];
        plane->normal[0] = cos(cut->azimuth_rad) * cos(cut->elevation_rad);
        plane->normal[1] = sin(cut->azimuth_rad) * cos(cut->elevation_rad);
        plane->normal[2] = sin(cut->elevation_rad);
        plane->offset_m = cut->distance_m;
    }
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
    size->bounding_radius_m *= 1.0 + 1e-6; /* rounding to single precision must not cut */
    set_cuts(size, object);
}

void shape_size_init_in_scene(struct shape_size *size, const struct scene *scene,
                              const sonject_object_params *object)
{
    shape_size_init(size, object);
    if (object->shape == SHAPE_MESH)
        shape_size_of_mesh(size, &scene->meshes[object->mesh]);
    if (object->shape == SHAPE_USER)
        shape_size_of_user_shape(size, &scene->user_shapes.shapes[object->user_shape]);
}

bool shape_is_convex(const struct shape_size *size, uint32_t shape)
{
    return !(shapes[shape].traits & SHAPE_IS_HOLLOW) && !size->nose.is_open && !size->tail.is_open;
}

/* With the first `cuts` of the cuts; the shape is convex and something of it is left. */
static double convex_extent(const struct shape_size *size, const struct shape *shape, uint32_t cuts,
                            const double v[3]);

/* The value of the dual at t. */
static double relaxed(const struct shape_size *size, const struct shape *shape, uint32_t cuts,
                      const double v[3], double t)
{
    const struct cut_plane *cut = &size->cuts[cuts - 1];
    double turned[3];
    for (int k = 0; k < 3; k++)
        turned[k] = v[k] - t * cut->normal[k];
    return convex_extent(size, shape, cuts - 1, turned) + t * cut->offset_m;
}

static double convex_extent(const struct shape_size *size, const struct shape *shape, uint32_t cuts,
                            const double v[3])
{
    if (cuts == 0)
        return shape->extent(size, v);
    double high = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0;
         i < 40 && relaxed(size, shape, cuts, v, 2.0 * high) < relaxed(size, shape, cuts, v, high);
         i++)
        high *= 2.0;
    double lower = 0.0;
    double upper = 2.0 * high;
    double least = fmin(relaxed(size, shape, cuts, v, lower), relaxed(size, shape, cuts, v, upper));
    double one = upper - GOLDEN * (upper - lower);
    double other = lower + GOLDEN * (upper - lower);
    double at_one = relaxed(size, shape, cuts, v, one);
    double at_other = relaxed(size, shape, cuts, v, other);
    for (int i = 0; i < STEPS; i++) {
        if (at_one < at_other) {
            upper = other;
            other = one;
            at_other = at_one;
            one = upper - GOLDEN * (upper - lower);
            at_one = relaxed(size, shape, cuts, v, one);
        } else {
            lower = one;
            one = other;
            at_one = at_other;
            other = lower + GOLDEN * (upper - lower);
            at_other = relaxed(size, shape, cuts, v, other);
        }
        least = fmin(least, fmin(at_one, at_other));
    }
    return least;
}

bool shape_is_left(const struct shape_size *size, uint32_t shape)
{
    const struct shape *row = shape_of(shape);
    if (size->cut_count == 0)
        return true;
    if (row->is_left)
        return row->is_left(size);
    /* nothing is left where some mean of the cuts lies beyond the whole shape */
    double lower = 0.0;
    double upper = 1.0;
    double least = INFINITY;
    for (int i = 0; i < STEPS; i++) {
        double values[2];
        for (int k = 0; k < 2; k++) {
            const double share =
                k == 0 ? upper - GOLDEN * (upper - lower) : lower + GOLDEN * (upper - lower);
            const struct cut_plane *one = &size->cuts[0];
            const struct cut_plane *other = &size->cuts[size->cut_count - 1];
            double back[3];
            for (int axis = 0; axis < 3; axis++)
                back[axis] = -(1.0 - share) * one->normal[axis] - share * other->normal[axis];
            values[k] =
                row->extent(size, back) + (1.0 - share) * one->offset_m + share * other->offset_m;
            least = fmin(least, values[k]);
        }
        if (values[0] < values[1])
            upper = lower + GOLDEN * (upper - lower);
        else
            lower = upper - GOLDEN * (upper - lower);
    }
    return least > 0.0;
}

double shape_extent(const struct shape_size *size, uint32_t shape, const double v[3])
{
    const struct shape *row = shape_of(shape);
    if (size->cut_count == 0)
        return row->extent(size, v);
    if (row->cut_extent)
        return row->cut_extent(size, v);
    return shape_is_left(size, shape) ? convex_extent(size, row, size->cut_count, v) : -INFINITY;
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
    record->cuts = (int32_t)size->cut_count;
    for (uint32_t i = 0; i < size->cut_count; i++) {
        record->cut[i].normal_x = (float)size->cuts[i].normal[0];
        record->cut[i].normal_y = (float)size->cuts[i].normal[1];
        record->cut[i].normal_z = (float)size->cuts[i].normal[2];
        record->cut[i].offset = (float)size->cuts[i].offset_m;
    }
}

/* 0 is a length that nobody gave, else rows of keys keep them in their bounds. */
static void check_sizes(struct check *check, const sonject_object_params *object, uint32_t needs)
{
    if (needs & SHAPE_HAS_LENGTH)
        check_positive_length(check, "length", object->length_m);
    if (needs & SHAPE_HAS_WIDTH)
        check_positive_length(check, "width", object->width_m);
    if (needs & SHAPE_HAS_DIAMETER)
        check_positive_length(check, "diameter", object->diameter_m);
    if (needs & SHAPE_HAS_HEIGHT)
        check_positive_length(check, "height", object->height_m);
}

void check_shape(struct check *check, const struct scene *scene,
                 const sonject_object_params *object)
{
    const struct shape *shape = shape_of(object->shape);
    struct shape_size size;
    check_sizes(check, object, shape->needs);
    if (shape->check)
        shape->check(check, object);
    const bool is_there = object->shape == SHAPE_MESH ? object->mesh < scene->mesh_count
                          : object->shape == SHAPE_USER
                              ? object->user_shape < scene->user_shapes.count
                              : object->shape != SHAPE_PARTS;
    if (check->status != SONJECT_OK || object->cut_count == 0 || !is_there)
        return;
    shape_size_init_in_scene(&size, scene, object);
    if (!shape_is_left(&size, object->shape))
        check_relation(check, "cuts", "length width diameter height mesh user",
                       "leave nothing of the object; move one outwards");
}
