/* The parts of a ray that run inside a shape. */
#ifndef SONJECT_KERNELS_INTERVAL_H
#define SONJECT_KERNELS_INTERVAL_H

#include "vector3.h"

#define FAR_AWAY 1.0e30f

/* Distances along the ray; empty if entry > exit. */
struct interval {
    vfloat entry, exit;
};

FUNCTION struct interval interval_where(mask m, vfloat entry, vfloat exit)
{
    struct interval inside;
    inside.entry = SELECT(m, entry, SPLAT(FAR_AWAY));
    inside.exit = SELECT(m, exit, SPLAT(-FAR_AWAY));
    return inside;
}

FUNCTION struct interval interval_overlap(struct interval a, struct interval b)
{
    const vfloat entry = larger(a.entry, b.entry);
    const vfloat exit = smaller(a.exit, b.exit);
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
FUNCTION struct interval interval_of_slab(vfloat start, vfloat step, float extent)
{
    /* a ray along the slab becomes one that leaves it 10^20 m away */
    const vfloat safe = SELECT(MASK_OF(magnitude(step) < 1.0e-20f), SPLAT(1.0e-20f), step);
    const vfloat to_lower = (-extent - start) / safe;
    const vfloat to_upper = (extent - start) / safe;
    struct interval inside;
    inside.entry = smaller(to_lower, to_upper);
    inside.exit = larger(to_lower, to_upper);
    return inside;
}

/* Inside a half space: by `depth` where the distance is 0, by `loss` less with each metre. */
FUNCTION struct interval interval_of_half_space(vfloat depth, vfloat loss)
{
    const vfloat safe = SELECT(MASK_OF(magnitude(loss) < 1.0e-20f), SPLAT(1.0e-20f), loss);
    const vfloat to_face = depth / safe;
    const mask is_leaving = MASK_OF(safe > 0.0f);
    struct interval inside;
    inside.entry = SELECT(is_leaving, SPLAT(-FAR_AWAY), to_face);
    inside.exit = SELECT(is_leaving, to_face, SPLAT(FAR_AWAY));
    return inside;
}

/* What a ray has of any shape: `second` only of those that are not convex or not solid; it lies
 * beyond the first where both are there. */
struct spans {
    struct interval first, second;
};

FUNCTION struct spans spans_of_one(struct interval only)
{
    struct spans spans;
    spans.first = only;
    spans.second.entry = SPLAT(FAR_AWAY);
    spans.second.exit = SPLAT(-FAR_AWAY);
    return spans;
}

#endif
