/* Points and directions in the frame of the patch: x along-track, y horizontal range, z up. */
#ifndef SONJECT_KERNELS_VECTOR3_H
#define SONJECT_KERNELS_VECTOR3_H

#include "width.h"

struct vector3 {
    vfloat x, y, z;
};

FUNCTION vfloat dot3(struct vector3 a, struct vector3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* Returns a + b * t. */
FUNCTION struct vector3 along3(struct vector3 a, struct vector3 b, vfloat t)
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

FUNCTION struct vector3 reflected3(struct vector3 v, struct vector3 normal)
{
    return along3(v, normal, -2.0f * dot3(v, normal));
}

FUNCTION struct vector3 minus3(struct vector3 a, struct vector3 b)
{
    return along3(a, b, SPLAT(-1.0f));
}

FUNCTION struct vector3 choose3(mask m, struct vector3 yes, struct vector3 no)
{
    struct vector3 chosen;
    chosen.x = SELECT(m, yes.x, no.x);
    chosen.y = SELECT(m, yes.y, no.y);
    chosen.z = SELECT(m, yes.z, no.z);
    return chosen;
}

/* Finds two unit vectors that make a right-handed frame with a unit normal. The frame is Frisvad's,
 * mirrored for normals that point down so that the divisor stays above 1. Near the axes it has no
 * branch that would jump. */
FUNCTION void tangents3(struct vector3 normal, struct vector3 *first, struct vector3 *second)
{
    const mask is_upward = MASK_OF(normal.z >= 0.0f);
    const vfloat sign = SELECT(is_upward, SPLAT(1.0f), SPLAT(-1.0f));
    const vfloat a = -1.0f / (sign + normal.z);
    const vfloat b = normal.x * normal.y * a;
    first->x = 1.0f + sign * normal.x * normal.x * a;
    first->y = sign * b;
    first->z = -sign * normal.x;
    second->x = b;
    second->y = sign + normal.y * normal.y * a;
    second->z = -normal.y;
}

/* Returns first * a + second * b + third * c. */
FUNCTION struct vector3 combine3(struct vector3 first, vfloat a, struct vector3 second, vfloat b,
                                 struct vector3 third, vfloat c)
{
    struct vector3 sum;
    sum.x = first.x * a + second.x * b + third.x * c;
    sum.y = first.y * a + second.y * b + third.y * c;
    sum.z = first.z * a + second.z * b + third.z * c;
    return sum;
}

/* Stores the vectors of all lanes, to be read one by one. */
FUNCTION void store_vector3(struct vector3 v, float lanes[3][WIDTH])
{
    STORE_VFLOAT(v.x, lanes[0]);
    STORE_VFLOAT(v.y, lanes[1]);
    STORE_VFLOAT(v.z, lanes[2]);
}

/* Broadcasts one lane's vector to all lanes. */
FUNCTION struct vector3 splat_vector3(const float lanes[3][WIDTH], int lane)
{
    struct vector3 v;
    v.x = SPLAT(lanes[0][lane]);
    v.y = SPLAT(lanes[1][lane]);
    v.z = SPLAT(lanes[2][lane]);
    return v;
}

FUNCTION struct vector3 load_lanes3(float lanes[3][WIDTH])
{
    struct vector3 v;
    v.x = LOAD_VFLOAT(lanes[0]);
    v.y = LOAD_VFLOAT(lanes[1]);
    v.z = LOAD_VFLOAT(lanes[2]);
    return v;
}

/* Loads one vector a lane, from the elements `slot` on. */
FUNCTION struct vector3 load_vector3(GLOBAL const float *x, GLOBAL const float *y,
                                     GLOBAL const float *z, int slot)
{
    struct vector3 v;
    v.x = LOAD_VFLOAT(x + slot);
    v.y = LOAD_VFLOAT(y + slot);
    v.z = LOAD_VFLOAT(z + slot);
    return v;
}

#endif
