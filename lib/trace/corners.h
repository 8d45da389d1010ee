/* Echoes of several smooth faces one after the other, the first of which is a given part: one trace
 * for each pair of sources (the sonar and its images in mirrors). */
#ifndef SONJECT_TRACE_CORNERS_H
#define SONJECT_TRACE_CORNERS_H

#include "trace/source_pairs.h"
#include "trace/tracer.h"

struct corner_trace {
    struct span bins;            /* of its echoes, in the patch */
    double amplitude_of_quantum; /* m */
    struct fan_record fan;
    struct ray_table rays;
    struct trace_device on_device; /* without tallies worth the name */
    cl_mem sources;                /* source_pair_record */
    cl_mem corners;                /* corner_record */
    struct corner_record record;
};

struct corners {
    struct line_grid grid; /* that holds all echoes; laid out as glints are; no strips: no echoes */
    struct span first_hits; /* sub-strips that the part covers */
    struct span last_hits;  /* that all smooth parts cover */
    bool is_focused;
    struct corner_trace *traces; /* owned */
    size_t count;
    cl_mem tallies;                    /* of one trace */
    int32_t chunk;                     /* strips that they have room for */
    float *real_part, *imaginary_part; /* owned; of as many */
};

/* Whether sound from the part may meet a smooth face after it: the scene has two smooth parts, or
 * this one is smooth and not convex, and paths may have two interactions. */
bool corners_may_echo(const struct tracer *tracer, uint32_t part);

/* Bins of the patch where such echoes may lie, of the given size; count 0 if there are none. */
struct span corner_bins(const struct tracer *tracer, uint32_t part, const struct line_grid *grid);

/* Prepares the traces of a part. On success to be given to corners_end, also after later failures;
 * on failure nothing is held. Errors: DEVICE, MEMORY. */
sonject_status corners_begin(struct corners *corners, struct tracer *tracer, uint32_t part);
void corners_end(struct corners *corners);

/* Traces one pair's echoes of strips.count <= chunk sub-strips: complex amplitudes in m,
 * strips.count x traces[number].bins.count, in two planes. However strips are grouped, the sums are
 * the same. Errors: DEVICE, MEMORY. */
sonject_status corner_trace_strips(struct corners *corners, struct tracer *tracer, size_t number,
                                   struct span strips, float *real_part, float *imaginary_part);

/* Adds the echoes of strips, of any number, to planes of strips.count x grid->bins.count. */
sonject_status corners_add(struct corners *corners, struct tracer *tracer, struct span strips,
                           const struct line_grid *grid, float *real_part, float *imaginary_part);

#endif
