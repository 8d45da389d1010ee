/* The part of a ray that runs inside a convex shape. */
#ifndef SONJECT_KERNELS_INTERVAL_H
#define SONJECT_KERNELS_INTERVAL_H

#include "vector3.h"

#define FAR_AWAY 1.0e30f

/* Distances along the ray; empty if entry > exit. */
struct interval {
    real entry, exit;
};

FUNCTION struct interval interval_where(mask m, real entry, real exit)
{
    struct interval inside;
    inside.entry = CHOOSE(m, entry, SPLAT(FAR_AWAY));
    inside.exit = CHOOSE(m, exit, SPLAT(-FAR_AWAY));
    return inside;
}

FUNCTION struct interval interval_overlap(struct interval a, struct interval b)
{
    const real entry = larger(a.entry, b.entry);
    const real exit = smaller(a.exit, b.exit);
    return interval_where(MASK_OF(entry <= exit), entry, exit);
}

/* Of two parts of one convex shape. */
FUNCTION struct interval interval_union(struct interval a, struct interval b)
{
    struct interval both;
    both.entry = smaller(a.entry, b.entry);
    both.exit = larger(a.exit, b.exit);
    return both;
}

/* Inside |coordinate| <= extent, where coordinate = start + step * distance. */
FUNCTION struct interval interval_of_slab(real start, real step, float extent)
{
    /* a ray along the slab becomes one that leaves it 10^20 m away */
    const real safe = CHOOSE(MASK_OF(magnitude(step) < 1.0e-20f), SPLAT(1.0e-20f), step);
    const real to_lower = (-extent - start) / safe;
    const real to_upper = (extent - start) / safe;
    struct interval inside;
    inside.entry = smaller(to_lower, to_upper);
    inside.exit = larger(to_lower, to_upper);
    return inside;
}

#endif
