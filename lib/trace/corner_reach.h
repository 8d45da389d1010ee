/* Which paths over several smooth faces there may be, and where their echoes lie. */
#ifndef SONJECT_TRACE_CORNER_REACH_H
#define SONJECT_TRACE_CORNER_REACH_H

#include "trace/source_pairs.h"
#include "trace/tracer.h"

#define CORNER_PAIRS_MAX (SOURCES_MAX * (SOURCES_MAX + 1) / 2)

/* All pairs of sources of a part, the straight one first, that leave two interactions to objects.
 */
struct corner_pairs {
    struct source_pairs others;
    struct sound_source sonar;
    struct source_pair pair;
    bool has_begun;
};

void corner_pairs_begin(struct corner_pairs *pairs, const struct tracer *tracer, uint32_t part);

/* The next one, valid until the call after; NULL when there is none. */
const struct source_pair *corner_pairs_next(struct corner_pairs *pairs);

/* Bins of the patch where a pair's echoes may lie; count 0 if there are none. Of the grid only the
 * size of its bins is used. */
struct span corner_pair_bins(const struct tracer *tracer, uint32_t part,
                             const struct source_pair *pair, const struct line_grid *grid);

/* How much finer than glints' the rays to a part have to be, each way, since it spreads them over
 * what they meet next. */
double corner_rays_finer(const struct tracer *tracer, uint32_t part);

#endif
