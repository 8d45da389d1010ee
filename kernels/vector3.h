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

FUNCTION struct vector3 choose3(mask m, struct vector3 yes, struct vector3 no)
{
    struct vector3 chosen;
    chosen.x = CHOOSE(m, yes.x, no.x);
    chosen.y = CHOOSE(m, yes.y, no.y);
    chosen.z = CHOOSE(m, yes.z, no.z);
    return chosen;
}

#endif
