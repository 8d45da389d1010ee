/* All of one object's glints, straight, by way of mirrors and by way of further smooth faces, which
 * interfere: one trace for each pair of sources, added up on one grid. */
#ifndef SONJECT_TRACE_GLINTS_H
#define SONJECT_TRACE_GLINTS_H

#include "trace/corners.h"
#include "trace/smooth.h"

struct glints {
    struct line_grid grid;       /* that holds every trace's strips and bins */
    struct smooth_trace *traces; /* owned; the straight one is the first */
    size_t count;
    struct corners corners;            /* owned */
    float *real_part, *imaginary_part; /* owned; a chunk of one trace */
};

/* Prepares the traces of one object. On success to be given to glints_end, also after later
 * failures; on failure nothing is held. An object without a smooth part has grid.strips.count 0 and
 * nothing to trace. Errors: DEVICE, MEMORY. */
sonject_status glints_begin(struct glints *glints, struct tracer *tracer, uint32_t object);
void glints_end(struct glints *glints);

/* How many sub-strips a call of glints_trace may take. */
int32_t glints_chunk(const struct glints *glints);

/* Traces strips.count <= chunk sub-strips: complex amplitudes in m, strips.count x grid.bins.count,
 * in two planes. |sum|^2 is a cross-section in m^2. */
sonject_status glints_trace(struct glints *glints, struct tracer *tracer, struct span strips,
                            float *real_part, float *imaginary_part);

#endif
