/* Pairs of sources between which an object carries sound: by way of mirrors before, after or both.
 */
#ifndef SONJECT_TRACE_SOURCE_PAIRS_H
#define SONJECT_TRACE_SOURCE_PAIRS_H

#include "trace/sources.h"
#include "trace/tracer.h"

/* outgoing->bounces <= returning->bounces: the reverse path is counted along. */
struct source_pair {
    const struct sound_source *outgoing, *returning;
    uint32_t number; /* among all pairs of the scene, for the random numbers */
};

/* All pairs of one object but the straight one, in turn. */
struct source_pairs {
    const struct tracer *tracer;
    const struct placement *placement;
    struct sound_source sources[SOURCES_MAX];
    size_t count;
    size_t outgoing, returning; /* the pair found last */
};

/* The tracer is borrowed. */
void source_pairs_begin(struct source_pairs *pairs, const struct tracer *tracer, uint32_t object);

/* Finds the next pair (which points into *pairs) within the limit of interactions whose mirrors
 * return anything; false when there is none. */
bool source_pairs_next(struct source_pairs *pairs, struct source_pair *pair);

/* Bins of half the path out from one source to the object and home to the other. Of the grid only
 * the size of its bins is used. */
struct span source_pair_bins(const struct tracer *tracer, uint32_t object,
                             const struct source_pair *pair, const struct line_grid *grid);

/* Of these, the bins whose pulse reaches the patch; count 0 if there is none. */
struct span source_pair_bins_in_patch(const struct tracer *tracer, uint32_t object,
                                      const struct source_pair *pair, const struct line_grid *grid);

/* What of some bins, of the grid's size, has a pulse that reaches the patch. */
struct span bins_in_patch(const struct tracer *tracer, const struct line_grid *grid,
                          struct span bins);

/* The bins in the patch of all the object's pairs but the straight one; count 0 if there is none.
 */
struct span mirrored_bins(const struct tracer *tracer, uint32_t object,
                          const struct line_grid *grid);

/* The smallest span that holds both; a span of count 0 holds nothing. */
struct span span_join(struct span one, struct span other);

/* What both hold. */
struct span span_overlap(struct span one, struct span other);

/* Fills in the pair's record, and a fan from the outgoing source, in a frame centred on the
 * object. The fan as fan_record_init, its bins and phases those of half the path. Appends the rays
 * of both ways. Errors: as ray_table_add. */
sonject_status source_pair_aim(struct fan_record *fan, struct source_pair_record *record,
                               struct ray_table *rays, const struct tracer *tracer, uint32_t object,
                               const struct source_pair *pair, const struct line_grid *grid);

#endif
