/* Sizes of each shape. */
#include <math.h>

#include "scene/check_shape.h"
#include "scene/scene.h"
#include "scene/shape_size.h"

static void check_end(struct check *check, const sonject_object_params *object,
                      const char *const keys[2], uint32_t kind, double depth_m)
{
    check_choice(check, keys[0], kind, SONJECT_END_SPHERICAL + 1);
    if (!(depth_m >= 0.0 && depth_m <= 0.5 * object->diameter_m))
        check_relation(check, keys[1], "diameter", "must be 0...%g m (half the diameter), not %g",
                       0.5 * object->diameter_m, depth_m);
}

static void check_cylinder(struct check *check, const sonject_object_params *object)
{
    static const char *const nose_keys[2] = {"nose_end", "nose_end.depth"};
    static const char *const tail_keys[2] = {"tail_end", "tail_end.depth"};
    check_end(check, object, nose_keys, object->nose_end, object->nose_end_depth_m);
    check_end(check, object, tail_keys, object->tail_end, object->tail_end_depth_m);
    if (object->nose_end > SONJECT_END_SPHERICAL || object->tail_end > SONJECT_END_SPHERICAL)
        return;
    struct shape_size size;
    shape_size_init(&size, object);
    const double ends = size.nose.depth_m + size.tail.depth_m;
    if (object->length_m < ends)
        check_relation(check, "length", "diameter nose_end tail_end",
                       "of a cylinder includes its spherical ends and must be at least their %g m, "
                       "not %g m",
                       ends, object->length_m);
}

static void check_capsule(struct check *check, const sonject_object_params *object)
{
    if (object->length_m < object->diameter_m)
        check_relation(
            check, "length", "diameter",
            "of a capsule includes its round ends and must be at least its diameter, %g m, not "
            "%g m",
            object->diameter_m, object->length_m);
}

static void check_wedge(struct check *check, const sonject_object_params *object)
{
    if (!(object->front_height_m >= 0.0 && object->front_height_m <= object->height_m))
        check_relation(check, "front_height", "height", "must be 0...%g m (the height), not %g",
                       object->height_m, object->front_height_m);
}

static void check_torus(struct check *check, const sonject_object_params *object)
{
    if (object->diameter_m <= 2.0 * object->height_m)
        check_relation(check, "diameter", "height",
                       "of a torus is that of its outline and must be above twice its height, %g "
                       "m, or there is no hole; it is %g m",
                       2.0 * object->height_m, object->diameter_m);
}

static void check_cuts(struct check *check, const sonject_object_params *object)
{
    if (object->cut_count > SONJECT_CUTS_CAPACITY) {
        check_failure(check, "cuts", "must be at most %d, not %lu", SONJECT_CUTS_CAPACITY,
                      (unsigned long)object->cut_count);
        return;
    }
    for (uint32_t i = 0; i < object->cut_count; i++) {
        check_finite(check, "cuts", object->cuts[i].azimuth_rad);
        check_finite(check, "cuts", object->cuts[i].elevation_rad);
        check_coordinate(check, "cuts", object->cuts[i].distance_m);
    }
}

static void check_what_is_left(struct check *check, const sonject_object_params *object)
{
    struct shape_size size;
    shape_size_init(&size, object);
    if (!shape_is_left(&size, object->shape))
        check_relation(check, "cuts", "length width diameter height",
                       "leave nothing of the object; move one outwards");
}

/* What a shape needs; the others may be anything finite. */
static void check_needed(struct check *check, const sonject_object_params *object)
{
    const uint32_t shape = object->shape;
    const bool is_flat_or_boxy = shape == SONJECT_SHAPE_PLANE || shape == SONJECT_SHAPE_ELLIPSOID ||
                                 shape == SONJECT_SHAPE_BOX || shape == SONJECT_SHAPE_WEDGE;
    const bool has_height = shape >= SONJECT_SHAPE_ELLIPSOID;
    if (is_flat_or_boxy || shape == SONJECT_SHAPE_CYLINDER || shape == SONJECT_SHAPE_CAPSULE)
        check_positive_length(check, "length", object->length_m);
    if (is_flat_or_boxy)
        check_positive_length(check, "width", object->width_m);
    else
        check_positive_length(check, "diameter", object->diameter_m);
    if (has_height)
        check_positive_length(check, "height", object->height_m);
    if (shape == SONJECT_SHAPE_TRUNCATED_CONE)
        check_length(check, "top_diameter", object->top_diameter_m);
    check_finite(check, "length", object->length_m);
    check_finite(check, "width", object->width_m);
    check_finite(check, "diameter", object->diameter_m);
    check_finite(check, "height", object->height_m);
    check_finite(check, "top_diameter", object->top_diameter_m);
    check_finite(check, "front_height", object->front_height_m);
    check_finite(check, "nose_end.depth", object->nose_end_depth_m);
    check_finite(check, "tail_end.depth", object->tail_end_depth_m);
}

void check_shape(struct check *check, const sonject_object_params *object)
{
    check_choice(check, "shape", object->shape, SONJECT_SHAPE_USER + 1);
    if (object->shape > SONJECT_SHAPE_USER)
        return;
    if (object->shape == SONJECT_SHAPE_PARTS) {
        if (object->cut_count > 0)
            check_failure(check, "cuts", "are not made in objects of parts; cut the parts");
        return;
    }
    if (object->shape == SONJECT_SHAPE_MESH || object->shape == SONJECT_SHAPE_USER) {
        check_cuts(check, object);
        return; /* what they leave check_cuts_in_scene finds */
    }
    check_needed(check, object);
    if (object->shape == SONJECT_SHAPE_CYLINDER)
        check_cylinder(check, object);
    else if (object->shape == SONJECT_SHAPE_CAPSULE)
        check_capsule(check, object);
    else if (object->shape == SONJECT_SHAPE_WEDGE)
        check_wedge(check, object);
    else if (object->shape == SONJECT_SHAPE_TORUS)
        check_torus(check, object);
    check_cuts(check, object);
    if (check->status == SONJECT_OK)
        check_what_is_left(check, object);
}
