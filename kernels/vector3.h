/* Points and directions in the frame of the patch: x along-track, y horizontal range, z up. */
#ifndef SONJECT_KERNELS_VECTOR3_H
#define SONJECT_KERNELS_VECTOR3_H

#include "width.h"

struct vector3 {
    vfloat x, y, z;
};

FUNCTION struct vector3 vector3_of(vfloat x, vfloat y, vfloat z)
{
    struct vector3 v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}

FUNCTION struct vector3 zero3(void)
{
    return vector3_of(SPLAT(0.0f), SPLAT(0.0f), SPLAT(0.0f));
}

FUNCTION vfloat dot3(struct vector3 a, struct vector3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* Returns a + b * t. */
FUNCTION struct vector3 along3(struct vector3 a, struct vector3 b, vfloat t)
{
    return vector3_of(a.x + b.x * t, a.y + b.y * t, a.z + b.z * t);
}

FUNCTION struct vector3 scaled3(struct vector3 v, vfloat factor)
{
    return vector3_of(v.x * factor, v.y * factor, v.z * factor);
}

FUNCTION struct vector3 divided3(struct vector3 v, vfloat divisor)
{
    return vector3_of(v.x / divisor, v.y / divisor, v.z / divisor);
}

FUNCTION struct vector3 reversed3(struct vector3 v)
{
    return vector3_of(-v.x, -v.y, -v.z);
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
    return vector3_of(SELECT(m, yes.x, no.x), SELECT(m, yes.y, no.y), SELECT(m, yes.z, no.z));
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
    *first = vector3_of(1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    *second = vector3_of(b, sign + normal.y * normal.y * a, -normal.y);
}

/* Returns first * a + second * b + third * c. */
FUNCTION struct vector3 combine3(struct vector3 first, vfloat a, struct vector3 second, vfloat b,
                                 struct vector3 third, vfloat c)
{
    return vector3_of(first.x * a + second.x * b + third.x * c,
                      first.y * a + second.y * b + third.y * c,
                      first.z * a + second.z * b + third.z * c);
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
    return vector3_of(SPLAT(lanes[0][lane]), SPLAT(lanes[1][lane]), SPLAT(lanes[2][lane]));
}

FUNCTION struct vector3 load_lanes3(float lanes[3][WIDTH])
{
    return vector3_of(LOAD_VFLOAT(lanes[0]), LOAD_VFLOAT(lanes[1]), LOAD_VFLOAT(lanes[2]));
}

/* Loads one vector a lane, from the elements `slot` on. */
FUNCTION struct vector3 load_vector3(GLOBAL const float *x, GLOBAL const float *y,
                                     GLOBAL const float *z, int slot)
{
    return vector3_of(LOAD_VFLOAT(x + slot), LOAD_VFLOAT(y + slot), LOAD_VFLOAT(z + slot));
}

#endif
