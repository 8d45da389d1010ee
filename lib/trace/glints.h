/* The coherent part: one object's glints by physical optics, sub-strip by sub-strip. Those that go
 * straight and by image sources interfere: there is one trace for each pair of sources, and all are
 * added up on one grid. */
#ifndef SONJECT_TRACE_GLINTS_H
#define SONJECT_TRACE_GLINTS_H

#include "trace/image_sources.h"
#include "trace/tracer.h"

#define GLINT_CELL_WAVELENGTHS                                                                     \
    0.125 /* spacing of rays on the wavefront, where nothing allows more */

/* The launch's buffers. */
enum smooth_buffer {
    SMOOTH_OBJECTS,
    SMOOTH_TALLIES,
    SMOOTH_SOURCES /* image_pair_record; by image sources alone */
};

struct smooth_trace {
    struct line_grid grid;       /* that the object covers */
    double amplitude_of_quantum; /* m */
    int32_t chunk;               /* sub-strips that a call of smooth_trace_strips may take */
    struct launch launch;
};

/* Standard deviation in m of the shortest pulse that such bins are fine enough for. */
double glint_shortest_deviation(const struct line_grid *grid, double column_spacing_m);

/* Sizes of sub-strips and bins, and the sub-strips that a part covers. */
void glint_strips_init(struct line_grid *grid, const struct tracer *tracer, uint32_t part);

/* What a ray stands for: a cell of the wavefront, in m along the track and across the ray. */
struct glint_cell {
    double along, across;
};

/* Cells of so many wavelengths both ways, with as many more rays as the scene asks for. */
struct glint_cell glint_cell_of(const struct tracer *tracer, double wavelengths);

/* Rays of a fan, whose strips are known, from a source to a part; finer across it as the edges of
 * faces need it on which the path has this gradient there; 0: none have to be heard. */
void glint_fan_init(struct fan_record *fan, const struct tracer *tracer, uint32_t part,
                    const struct ray_path *path, struct glint_cell cell, double steepest);

/* Prepares a trace of one part's glints, straight there and back (pair NULL) or by way of
 * boundaries; as rough_trace_begin. A part without a smooth part has grid.strips.count 0 and
 * nothing to trace; grid.bins.count is 0, and there is nothing to trace, where no echo of a pair
 * can reach the patch. */
sonject_status smooth_trace_begin(struct smooth_trace *trace, struct tracer *tracer, uint32_t part,
                                  const struct image_pair *pair);
void smooth_trace_end(struct smooth_trace *trace);

/* Traces strips.count <= chunk sub-strips: complex amplitudes in m, strips.count x bins, in two
 * planes. |sum|^2 is a cross-section in m^2. */
sonject_status smooth_trace_strips(struct smooth_trace *trace, struct tracer *tracer,
                                   struct span strips, float *real_part, float *imaginary_part);

struct glints {
    struct line_grid grid;       /* that holds every trace's strips and bins */
    struct smooth_trace *traces; /* owned; the straight one is the first */
    size_t count;
    int32_t chunk;                     /* sub-strips that a call of glints_trace may take */
    float *real_part, *imaginary_part; /* owned; a chunk of one trace */
};

/* Prepares the traces of one part. On success to be given to glints_end, also after later
 * failures; on failure nothing is held. A part without a smooth part has grid.strips.count 0 and
 * nothing to trace. Errors: DEVICE, MEMORY. */
sonject_status glints_begin(struct glints *glints, struct tracer *tracer, uint32_t part);
void glints_end(struct glints *glints);

/* Traces strips.count <= chunk sub-strips: complex amplitudes in m, strips.count x grid.bins.count,
 * in two planes. |sum|^2 is a cross-section in m^2. */
sonject_status glints_trace(struct glints *glints, struct tracer *tracer, struct span strips,
                            float *real_part, float *imaginary_part);

#endif
