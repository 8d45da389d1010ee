/* Multi-bounce specular paths: echoes of several smooth faces one after the other, the first of
 * which is a given part. There is one trace for each pair of sources (the sonar and its images in
 * mirrors). */
#ifndef SONJECT_TRACE_CORNERS_H
#define SONJECT_TRACE_CORNERS_H

#include "trace/corner_sums.h"
#include "trace/image_sources.h"
#include "trace/tracer.h"

#define CORNER_PAIRS_MAX (SOURCES_MAX * (SOURCES_MAX + 1) / 2)

/* All pairs of sources of a part, the straight one first, that leave two interactions to objects.
 */
struct corner_pairs {
    struct image_pairs others;
    struct sound_source sonar;
    struct image_pair pair;
    bool has_begun;
};

void corner_pairs_begin(struct corner_pairs *pairs, const struct tracer *tracer, uint32_t part);

/* The next one, valid until the call after; NULL when there is none. */
const struct image_pair *corner_pairs_next(struct corner_pairs *pairs);

/* The echoes of one pair of sources. */
struct corner_trace {
    struct corner_sums sums;
    double amplitude_of_quantum; /* m */
};

struct corners {
    struct line_grid grid; /* that holds all echoes; laid out as glints are; no strips: no echoes */
    struct span first_hits;      /* sub-strips that the part covers */
    struct corner_trace *traces; /* owned */
    size_t count;
};

/* What a launch needs. */
struct corner_launch {
    struct fan_record fan;
    struct ray_table rays;
    struct corner_record record;
    struct image_pair_record sources;
    struct trace_device on_device; /* without tallies worth the name */
    device_buffer source_buffer, record_buffer, echoes, listed;
    size_t capacity; /* of echoes */
    int32_t chunk;   /* sub-strips whose echoes fit that */
};

/* Whether sound from the part may meet a smooth face after it: the scene has two smooth parts, or
 * this one is smooth and not convex, and paths may have two interactions. */
bool corners_may_echo(const struct tracer *tracer, uint32_t part);

/* Bins of the patch where such echoes may lie, of the given size; count 0 if there are none. */
struct span corner_bins(const struct tracer *tracer, uint32_t part, const struct line_grid *grid);

/* Traces all echoes that a part is the first to meet. On success to be given to corners_end; on
 * failure nothing is held. Errors: DEVICE, MEMORY. */
sonject_status corners_begin(struct corners *corners, struct tracer *tracer, uint32_t part);
void corners_end(struct corners *corners);

/* Adds the echoes of strips, complex amplitudes in m, to planes of strips.count x grid->bins.count.
 */
void corners_add(const struct corners *corners, struct span strips, const struct line_grid *grid,
                 float *real_part, float *imaginary_part);

/* The steps of corners_begin: the grid of one pair's echoes and its launch, whose echoes are listed
 * chunk by chunk of first hits. The grid's bins.count is 0, and nothing is held, where there can be
 * none; else to be given to corner_launch_end. */
void corners_init(struct corners *corners, const struct tracer *tracer, uint32_t part);
sonject_status corner_launch_begin(struct corner_launch *launch, struct line_grid *grid,
                                   const struct corners *corners, struct tracer *tracer,
                                   uint32_t part, const struct image_pair *pair);
void corner_launch_end(struct corner_launch *launch);

/* Adds the echoes of first hits in strips.count <= chunk sub-strips to the sums. */
sonject_status corner_launch_strips(struct corner_launch *launch, struct tracer *tracer,
                                    struct span strips, struct corner_sums *sums);

#endif
