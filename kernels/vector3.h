/* Points and directions in the frame of the patch: x along-track, y horizontal range, z up. */
#ifndef SONJECT_KERNELS_VECTOR3_H
#define SONJECT_KERNELS_VECTOR3_H

#include "width.h"

struct vector3 {
    real x, y, z;
};

FUNCTION real dot3(struct vector3 a, struct vector3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* a + b * t */
FUNCTION struct vector3 along3(struct vector3 a, struct vector3 b, real t)
{
    struct vector3 sum;
    sum.x = a.x + b.x * t;
    sum.y = a.y + b.y * t;
    sum.z = a.z + b.z * t;
    return sum;
}

FUNCTION struct vector3 reversed3(struct vector3 v)
{
    struct vector3 back;
    back.x = -v.x;
    back.y = -v.y;
    back.z = -v.z;
    return back;
}

FUNCTION struct vector3 choose3(mask m, struct vector3 yes, struct vector3 no)
{
    struct vector3 chosen;
    chosen.x = CHOOSE(m, yes.x, no.x);
    chosen.y = CHOOSE(m, yes.y, no.y);
    chosen.z = CHOOSE(m, yes.z, no.z);
    return chosen;
}

/* Two unit vectors that make a right-handed frame with a unit normal. Formed without a branch that
 * would jump near the axes (Frisvad's frame, mirrored for normals that point down so that the
 * divisor stays above 1). */
FUNCTION void tangents3(struct vector3 normal, struct vector3 *first, struct vector3 *second)
{
    const mask is_upward = MASK_OF(normal.z >= 0.0f);
    const real sign = CHOOSE(is_upward, SPLAT(1.0f), SPLAT(-1.0f));
    const real a = -1.0f / (sign + normal.z);
    const real b = normal.x * normal.y * a;
    first->x = 1.0f + sign * normal.x * normal.x * a;
    first->y = sign * b;
    first->z = -sign * normal.x;
    second->x = b;
    second->y = sign + normal.y * normal.y * a;
    second->z = -normal.y;
}

/* first * a + second * b + third * c */
FUNCTION struct vector3 combine3(struct vector3 first, real a, struct vector3 second, real b,
                                 struct vector3 third, real c)
{
    struct vector3 sum;
    sum.x = first.x * a + second.x * b + third.x * c;
    sum.y = first.y * a + second.y * b + third.y * c;
    sum.z = first.z * a + second.z * b + third.z * c;
    return sum;
}

#endif
