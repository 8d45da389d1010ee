/* A box about the origin of its own frame (half_length, half_width, half_height), and the wedge, a
 * box whose top slants down to the nose. The wedge's slant_across is along x. */
#ifndef SONJECT_KERNELS_SHAPES_BOX_H
#define SONJECT_KERNELS_SHAPES_BOX_H

#include "interval.h"
#include "layout.h"

FUNCTION struct interval box_interval(GLOBAL const struct object_record *object,
                                      struct vector3 point, struct vector3 direction)
{
    return interval_overlap(
        interval_overlap(interval_of_slab(point.x, direction.x, object->half_length),
                         interval_of_slab(point.y, direction.y, object->half_width)),
        interval_of_slab(point.z, direction.z, object->half_height));
}

FUNCTION struct spans box_spans(GLOBAL const struct object_record *object, struct vector3 point,
                                struct vector3 direction)
{
    return spans_of_one(box_interval(object, point, direction));
}

/* The slanted face is the wedge's top, given by its unit normal (x and z) and offset. */
FUNCTION struct spans wedge_spans(GLOBAL const struct object_record *object, struct vector3 point,
                                  struct vector3 direction)
{
    const vfloat depth =
        object->slant_offset - (point.x * object->slant_across + point.z * object->slant_up);
    const vfloat loss = direction.x * object->slant_across + direction.z * object->slant_up;
    return spans_of_one(interval_overlap(box_interval(object, point, direction),
                                         interval_of_half_space(depth, loss)));
}

/* Takes a face's normal where the point lies further out (or less deep) than for earlier faces. */
FUNCTION void offer_face(vfloat height, struct vector3 candidate, vfloat *highest,
                         struct vector3 *normal)
{
    const mask is_higher = MASK_OF(height > *highest);
    *normal = choose3(is_higher, candidate, *normal);
    *highest = SELECT(is_higher, height, *highest);
}

/* Returns the normal of the nearest of the box's faces. */
FUNCTION struct vector3 normal_of_side(GLOBAL const struct object_record *object,
                                       struct vector3 point, vfloat *highest)
{
    const vfloat zero = SPLAT(0.0f);
    struct vector3 normal = vector3_of(sign_of(point.x), zero, zero);
    *highest = magnitude(point.x) - object->half_length;
    offer_face(magnitude(point.y) - object->half_width, vector3_of(zero, sign_of(point.y), zero),
               highest, &normal);
    offer_face(magnitude(point.z) - object->half_height, vector3_of(zero, zero, sign_of(point.z)),
               highest, &normal);
    return normal;
}

FUNCTION struct vector3 box_normal(GLOBAL const struct object_record *object, struct vector3 point,
                                   struct vector3 direction)
{
    vfloat highest;
    (void)direction;
    return normal_of_side(object, point, &highest);
}

FUNCTION struct vector3 wedge_normal(GLOBAL const struct object_record *object,
                                     struct vector3 point, struct vector3 direction)
{
    vfloat highest;
    (void)direction;
    struct vector3 normal = normal_of_side(object, point, &highest);
    const struct vector3 slant =
        vector3_of(SPLAT(object->slant_across), SPLAT(0.0f), SPLAT(object->slant_up));
    offer_face(point.x * object->slant_across + point.z * object->slant_up - object->slant_offset,
               slant, &highest, &normal);
    return normal;
}

#endif
