/* Box about the origin of its own frame, and the wedge, a box whose top slants down to the nose. */
#ifndef SONJECT_KERNELS_SHAPES_BOX_H
#define SONJECT_KERNELS_SHAPES_BOX_H

#include "interval.h"

FUNCTION struct interval box_interval(struct vector3 point, struct vector3 direction,
                                      float half_length, float half_width, float half_height)
{
    return interval_overlap(interval_overlap(interval_of_slab(point.x, direction.x, half_length),
                                             interval_of_slab(point.y, direction.y, half_width)),
                            interval_of_slab(point.z, direction.z, half_height));
}

/* slant: unit normal (x and z) and offset of the wedge's top. */
FUNCTION struct interval wedge_interval(struct vector3 point, struct vector3 direction,
                                        float half_length, float half_width, float half_height,
                                        float slant_x, float slant_z, float slant_offset)
{
    const vfloat depth = slant_offset - (point.x * slant_x + point.z * slant_z);
    const vfloat loss = direction.x * slant_x + direction.z * slant_z;
    return interval_overlap(box_interval(point, direction, half_length, half_width, half_height),
                            interval_of_half_space(depth, loss));
}

/* A face's normal where the point lies further out (or less deep) than all faces before. */
FUNCTION void offer_face(vfloat height, struct vector3 candidate, vfloat *highest,
                         struct vector3 *normal)
{
    const mask is_higher = MASK_OF(height > *highest);
    *normal = choose3(is_higher, candidate, *normal);
    *highest = SELECT(is_higher, height, *highest);
}

/* Of the face that is nearest. */
FUNCTION struct vector3 box_normal(struct vector3 point, float half_length, float half_width,
                                   float half_height, vfloat *highest)
{
    struct vector3 end, side, top, normal;
    end.x = SELECT(MASK_OF(point.x < 0.0f), SPLAT(-1.0f), SPLAT(1.0f));
    end.y = end.z = SPLAT(0.0f);
    side.y = SELECT(MASK_OF(point.y < 0.0f), SPLAT(-1.0f), SPLAT(1.0f));
    side.x = side.z = SPLAT(0.0f);
    top.z = SELECT(MASK_OF(point.z < 0.0f), SPLAT(-1.0f), SPLAT(1.0f));
    top.x = top.y = SPLAT(0.0f);
    *highest = magnitude(point.x) - half_length;
    normal = end;
    offer_face(magnitude(point.y) - half_width, side, highest, &normal);
    offer_face(magnitude(point.z) - half_height, top, highest, &normal);
    return normal;
}

FUNCTION struct vector3 wedge_normal(struct vector3 point, float half_length, float half_width,
                                     float half_height, float slant_x, float slant_z,
                                     float slant_offset)
{
    vfloat highest;
    struct vector3 normal = box_normal(point, half_length, half_width, half_height, &highest);
    struct vector3 slant;
    slant.x = SPLAT(slant_x);
    slant.y = SPLAT(0.0f);
    slant.z = SPLAT(slant_z);
    offer_face(point.x * slant_x + point.z * slant_z - slant_offset, slant, &highest, &normal);
    return normal;
}

#endif
