/* The coherent part: one object's glints by physical optics, in sub-strips of at most a quarter
 * wavelength. Glints that go straight and by image sources interfere, so each pair of sources has a
 * trace, and one grid adds up all of them. */
#ifndef SONJECT_TRACE_GLINTS_H
#define SONJECT_TRACE_GLINTS_H

#include "trace/image_sources.h"
#include "trace/tracer.h"

#define GLINT_CELL_WAVELENGTHS                                                                     \
    0.125 /* spacing of rays on the wavefront, where nothing allows more */

struct smooth_trace {
    struct line_grid grid;       /* the cells that the object covers */
    double amplitude_of_quantum; /* m */
    int32_t chunk;               /* sub-strips that a call of smooth_trace_strips may take */
    struct launch launch;
};

/* Returns the standard deviation, m, of the shortest pulse that the bins are fine enough for. */
double glint_shortest_deviation(const struct line_grid *grid, double column_spacing_m);

/* Sets the sizes of sub-strips and bins, and the sub-strips that a part covers. */
void glint_strips_init(struct line_grid *grid, const struct tracer *tracer, uint32_t part);

/* The cell of the wavefront that a ray stands for, m along the track and across the ray. */
struct glint_cell {
    double along, across;
};

/* Returns cells of so many wavelengths each way, made smaller by the scene's ray scale. */
struct glint_cell glint_cell_of(const struct tracer *tracer, double wavelengths);

/* Lays the rays of a fan, whose strips are known, from a source to a part. Edges of faces need
 * finer cells across the ray. steepest: the path's gradient on those faces; 0: no edge is heard. */
void glint_fan_init(struct fan_record *fan, const struct tracer *tracer, uint32_t part,
                    const struct ray_path *path, struct glint_cell cell, double steepest);

/* Prepares a trace of one part's glints like rough_trace_begin: straight there and back (pair
 * NULL), or by way of boundaries. A part without a smooth part has grid.strips.count 0.
 * grid.bins.count is 0 where no echo of a pair reaches the patch. Both have nothing to trace. */
sonject_status smooth_trace_begin(struct smooth_trace *trace, struct tracer *tracer, uint32_t part,
                                  const struct image_pair *pair);
void smooth_trace_end(struct smooth_trace *trace);

/* Traces strips.count <= chunk sub-strips into two planes of strips.count x bins: complex
 * amplitudes, m. |sum|^2 is a cross-section in m^2. */
sonject_status smooth_trace_strips(struct smooth_trace *trace, struct tracer *tracer,
                                   struct span strips, float *real_part, float *imaginary_part);

struct glints {
    struct line_grid grid;       /* holds every trace's strips and bins */
    struct smooth_trace *traces; /* owned; the straight trace is the first */
    size_t count;
    int32_t chunk;                     /* sub-strips that a call of glints_trace may take */
    float *real_part, *imaginary_part; /* owned; a chunk of one trace */
};

/* Prepares the traces of one part. After success the caller calls glints_end, also after later
 * failures; on failure nothing is held. A part without a smooth part has grid.strips.count 0 and
 * nothing to trace. Errors: DEVICE, MEMORY. */
sonject_status glints_begin(struct glints *glints, struct tracer *tracer, uint32_t part);
void glints_end(struct glints *glints);

/* Traces strips.count <= chunk sub-strips into two planes of strips.count x grid.bins.count:
 * complex amplitudes, m. |sum|^2 is a cross-section in m^2. */
sonject_status glints_trace(struct glints *glints, struct tracer *tracer, struct span strips,
                            float *real_part, float *imaginary_part);

#endif
