/* A cone or truncated cone about the z axis of its own frame, with flat ends: half_height, radius
 * (of its larger end) and the slanted face. */
#ifndef SONJECT_KERNELS_SHAPES_CONE_H
#define SONJECT_KERNELS_SHAPES_CONE_H

#include "interval.h"
#include "layout.h"

/* The slanted face is the side, given by its unit normal (radial and z) and offset: slant_across *
 * (distance from the axis) = slant_offset - slant_up * z. The square of this equation describes a
 * double cone, whose other half lies beyond the ends. */
FUNCTION struct spans cone_spans(GLOBAL const struct object_record *object, struct vector3 point,
                                 struct vector3 direction)
{
    const float slant_across = object->slant_across;
    const float slant_up = object->slant_up;
    const struct interval slab = interval_of_slab(point.z, direction.z, object->half_height);
    const float square_across = slant_across * slant_across;
    const vfloat widening = -slant_up * direction.z;
    const vfloat steepness =
        square_across * (direction.x * direction.x + direction.y * direction.y) -
        widening * widening;
    const vfloat a = SELECT(MASK_OF(magnitude(steepness) < 1.0e-14f), SPLAT(1.0e-14f), steepness);
    const vfloat from_here = square_across * (point.x * direction.x + point.y * direction.y) -
                             widening * (object->slant_offset - slant_up * point.z);
    /* Distances count from where the ray is deepest within the slab; nothing cancels there. */
    const vfloat limit = SPLAT(2.0f * (object->radius + object->half_height));
    const vfloat deepest = smaller(larger(-from_here / a, slab.entry), slab.exit);
    const vfloat start = smaller(larger(deepest, -limit), limit);
    const struct vector3 p = along3(point, direction, start);
    const vfloat outer = slant_across * SQUARE_ROOT(p.x * p.x + p.y * p.y);
    const vfloat side = object->slant_offset - slant_up * p.z;
    const vfloat b = square_across * (p.x * direction.x + p.y * direction.y) - widening * side;
    const vfloat c = (outer - side) * (outer + side);
    const vfloat square = b * b - a * c;
    const vfloat root = SQUARE_ROOT(larger(square, SPLAT(0.0f)));
    const vfloat sum = SELECT(MASK_OF(b < 0.0f), root - b, -(root + b));
    const vfloat safe = SELECT(MASK_OF(magnitude(sum) < 1.0e-20f), SPLAT(1.0e-20f), sum);
    const vfloat one = start + safe / a;
    const vfloat other = start + c / safe;
    const vfloat lower = smaller(one, other);
    const vfloat upper = larger(one, other);
    /* A ray steeper than the side runs in one half up to its crossing, or in it from there on. */
    const mask is_steep = MASK_OF(a < 0.0f);
    const mask widens = MASK_OF(widening > 0.0f);
    const vfloat entry = SELECT(is_steep, SELECT(widens, upper, SPLAT(-FAR_AWAY)), lower);
    const vfloat exit = SELECT(is_steep, SELECT(widens, SPLAT(FAR_AWAY), lower), upper);
    return spans_of_one(
        interval_overlap(interval_where(is_steep | MASK_OF(square > 0.0f), entry, exit), slab));
}

/* Returns the normal of the end if the point is nearer to an end than to the side. */
FUNCTION struct vector3 cone_normal(GLOBAL const struct object_record *object, struct vector3 point,
                                    struct vector3 direction)
{
    const float slant_across = object->slant_across;
    const float slant_up = object->slant_up;
    const vfloat from_axis = SQUARE_ROOT(point.x * point.x + point.y * point.y);
    const vfloat over_side = slant_across * from_axis + slant_up * point.z - object->slant_offset;
    const mask on_end = MASK_OF(magnitude(point.z) - object->half_height > over_side);
    const mask is_on_axis = MASK_OF(from_axis <= 0.0f);
    const vfloat safe = SELECT(is_on_axis, SPLAT(1.0f), from_axis);
    (void)direction;
    const struct vector3 end = vector3_of(SPLAT(0.0f), SPLAT(0.0f), sign_of(point.z));
    const struct vector3 side =
        vector3_of(slant_across * SELECT(is_on_axis, SPLAT(1.0f), point.x / safe),
                   slant_across * (point.y / safe), SPLAT(slant_up));
    return choose3(on_end, end, side);
}

#endif
