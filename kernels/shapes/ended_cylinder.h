/* A cylinder along the x axis of its own frame. Each of its ends is flat, open, or a part of a
 * sphere. With an open end it is a thin wall, seen from both sides; otherwise it is solid. Its
 * sizes are the radius and the ends. */
#ifndef SONJECT_KERNELS_SHAPES_ENDED_CYLINDER_H
#define SONJECT_KERNELS_SHAPES_ENDED_CYLINDER_H

#include "layout.h"
#include "shapes/cylinder.h"

/* Returns where a ray is inside the end's sphere and beyond its joint. The sphere is written from
 * its pole, curvature/2 |q|^2 + q_x <= 0, so that nearly flat ends lose no digits. outward: 1 nose,
 * -1 tail. */
FUNCTION struct interval round_end_interval(struct vector3 point, struct vector3 direction,
                                            GLOBAL const struct end_record *end, float outward)
{
    struct vector3 from_pole = point;
    from_pole.x = point.x - outward * (end->joint + end->depth);
    const vfloat start = -dot3(from_pole, direction);
    const struct vector3 q = along3(from_pole, direction, start);
    const float a = 0.5f * end->curvature;
    const vfloat b = a * dot3(q, direction) + (0.5f * outward) * direction.x;
    const vfloat c = a * dot3(q, q) + outward * q.x;
    const vfloat square = b * b - a * c;
    const vfloat root = SQUARE_ROOT(larger(square, SPLAT(0.0f)));
    const vfloat sum = SELECT(MASK_OF(b < 0.0f), root - b, -(root + b));
    const vfloat safe = SELECT(MASK_OF(magnitude(sum) < 1.0e-20f), SPLAT(1.0e-20f), sum);
    const vfloat one = start + safe / a;
    const vfloat other = start + c / safe;
    return interval_overlap(
        interval_where(MASK_OF(square > 0.0f), smaller(one, other), larger(one, other)),
        interval_of_half_space(outward * point.x - end->joint, -outward * direction.x));
}

FUNCTION struct interval straight_part_slab(struct vector3 point, struct vector3 direction,
                                            GLOBAL const struct end_record *ends)
{
    const float middle = 0.5f * (ends[END_NOSE].joint - ends[END_TAIL].joint);
    const float half_length = 0.5f * (ends[END_NOSE].joint + ends[END_TAIL].joint);
    return interval_of_slab(point.x - middle, direction.x, half_length);
}

/* Treats the cylinder as solid, with flat ends in place of open ones. */
FUNCTION struct interval ended_cylinder_interval(GLOBAL const struct object_record *object,
                                                 struct vector3 point, struct vector3 direction)
{
    GLOBAL const struct end_record *ends = object->ends;
    struct interval inside = interval_overlap(tube_interval(point, direction, object->radius),
                                              straight_part_slab(point, direction, ends));
    for (int end = END_NOSE; end <= END_TAIL; end++)
        if (ends[end].depth > 0.0f)
            inside = interval_union(inside, round_end_interval(point, direction, &ends[end],
                                                               end == END_NOSE ? 1.0f : -1.0f));
    return inside;
}

FUNCTION struct spans ended_cylinder_spans(GLOBAL const struct object_record *object,
                                           struct vector3 point, struct vector3 direction)
{
    return spans_of_one(ended_cylinder_interval(object, point, direction));
}

/* Returns where the ray crosses the wall, on the way in and on the way out, as intervals of no
 * length. Crossings of an open end do not count. */
FUNCTION struct spans open_cylinder_spans(GLOBAL const struct object_record *object,
                                          struct vector3 point, struct vector3 direction)
{
    GLOBAL const struct end_record *ends = object->ends;
    const struct interval slab = straight_part_slab(point, direction, ends);
    const struct interval inside = ended_cylinder_interval(object, point, direction);
    const mask never = MASK_OF(direction.x > FAR_AWAY);
    const mask nose_is_open = ends[END_NOSE].is_open ? ~never : never;
    const mask tail_is_open = ends[END_TAIL].is_open ? ~never : never;
    const mask is_forward = MASK_OF(direction.x > 0.0f);
    const mask is_met = MASK_OF(inside.entry <= inside.exit);
    const mask enters_open = MASK_OF(inside.entry == slab.entry) &
                             ((is_forward & tail_is_open) | (~is_forward & nose_is_open));
    const mask leaves_open = MASK_OF(inside.exit == slab.exit) &
                             ((is_forward & nose_is_open) | (~is_forward & tail_is_open));
    struct spans spans;
    spans.first = interval_where(is_met & ~enters_open, inside.entry, inside.entry);
    spans.second = interval_where(is_met & ~leaves_open, inside.exit, inside.exit);
    return spans;
}

/* Returns the outward normal, a flat end's if the point is nearer to the end than to the side. */
FUNCTION struct vector3 ended_cylinder_normal(GLOBAL const struct object_record *object,
                                              struct vector3 point, struct vector3 direction)
{
    const vfloat from_axis = SQUARE_ROOT(point.y * point.y + point.z * point.z);
    const vfloat safe = SELECT(MASK_OF(from_axis > 0.0f), from_axis, SPLAT(1.0f));
    struct vector3 normal = vector3_of(SPLAT(0.0f), point.y / safe, point.z / safe);
    (void)direction;
    for (int number = END_NOSE; number <= END_TAIL; number++) {
        GLOBAL const struct end_record *end = &object->ends[number];
        const float outward = number == END_NOSE ? 1.0f : -1.0f;
        const vfloat to_joint = end->joint - outward * point.x;
        const vfloat from_pole =
            1.0f + end->curvature * (outward * point.x - (end->joint + end->depth));
        const struct vector3 on_end =
            vector3_of(outward * from_pole, end->curvature * point.y, end->curvature * point.z);
        const mask is_there = end->depth > 0.0f ? MASK_OF(to_joint < 0.0f)
                                                : MASK_OF(to_joint < object->radius - from_axis);
        if (!end->is_open)
            normal = choose3(is_there, on_end, normal);
    }
    return normal;
}

/* Returns the normal on the side that the ray comes from. */
FUNCTION struct vector3 open_cylinder_normal(GLOBAL const struct object_record *object,
                                             struct vector3 point, struct vector3 direction)
{
    const struct vector3 outward = ended_cylinder_normal(object, point, direction);
    return choose3(MASK_OF(dot3(outward, direction) > 0.0f), reversed3(outward), outward);
}

#endif
