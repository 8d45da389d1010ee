/* The parts of a ray that run inside a shape. */
#ifndef SONJECT_KERNELS_INTERVAL_H
#define SONJECT_KERNELS_INTERVAL_H

#include "vector3.h"

#define FAR_AWAY 1.0e30f

/* A range of distances along a ray. It is empty if entry > exit. */
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

/* Returns the union of two intervals, which are parts of one convex shape. */
FUNCTION struct interval interval_union(struct interval a, struct interval b)
{
    struct interval both;
    both.entry = smaller(a.entry, b.entry);
    both.exit = larger(a.exit, b.exit);
    return both;
}

/* Returns where |coordinate| <= extent, with coordinate = start + step * distance. */
FUNCTION struct interval interval_of_slab(vfloat start, vfloat step, float extent)
{
    /* A ray parallel to the slab gets a slope by which it leaves 10^20 m away. */
    const vfloat safe = SELECT(MASK_OF(magnitude(step) < 1.0e-20f), SPLAT(1.0e-20f), step);
    const vfloat to_lower = (-extent - start) / safe;
    const vfloat to_upper = (extent - start) / safe;
    struct interval inside;
    inside.entry = smaller(to_lower, to_upper);
    inside.exit = larger(to_lower, to_upper);
    return inside;
}

/* Returns where a ray is inside a half space. depth: at distance 0; loss: of depth, per metre. */
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

/* The intervals of a ray inside any shape. Only shapes that are not convex or not solid have a
 * second one. If both exist, the second lies beyond the first. */
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
