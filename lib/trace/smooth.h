/* The coherent part: the glints of one object by physical optics, sub-strip by sub-strip. */
#ifndef SONJECT_TRACE_SMOOTH_H
#define SONJECT_TRACE_SMOOTH_H

#include "trace/source_pairs.h"
#include "trace/tracer.h"

#define GLINT_CELL_WAVELENGTHS 0.125 /* spacing of rays on the wavefront */

struct smooth_trace {
    struct line_grid grid;       /* that the object covers */
    double amplitude_of_quantum; /* m */
    struct fan_record fan;
    struct ray_table rays;
    struct trace_device on_device;
    cl_mem sources; /* source_pair_record; NULL: straight there and back */
};

/* Sizes of the strips and bins of all glints: strips_per_row and bins_per_pixel of the grid. */
void glint_cells_lay(struct line_grid *grid, const struct tracer *tracer);

/* Standard deviation in m of the shortest pulse that such bins are fine enough for. */
double glint_shortest_deviation(const struct line_grid *grid, double column_spacing_m);

/* Sizes of sub-strips and bins, and the sub-strips that a part covers. */
void glint_strips_lay(struct line_grid *grid, const struct tracer *tracer, uint32_t part);

/* Rays of a fan, whose strips are known, from a source to a part; `finer` than glints need them by
 * that factor each way, >= 1. */
void glint_fan_lay(struct fan_record *fan, const struct tracer *tracer, uint32_t part,
                   const struct water_way *way, double finer);

/* Prepares a trace of one object's glints; as rough_trace_begin. An object without a smooth part
 * has grid.strips.count 0 and nothing to trace. */
sonject_status smooth_trace_begin(struct smooth_trace *trace, struct tracer *tracer,
                                  uint32_t object);

/* The same by way of mirrors. grid.bins.count is 0, and there is nothing to trace, where no such
 * echo can reach the patch. */
sonject_status smooth_trace_begin_mirrored(struct smooth_trace *trace, struct tracer *tracer,
                                           uint32_t object, const struct source_pair *pair);
void smooth_trace_end(struct smooth_trace *trace);

int32_t smooth_trace_chunk(const struct smooth_trace *trace);

/* Traces strips.count <= chunk sub-strips: complex amplitudes in m, strips.count x bins, in two
 * planes. |sum|^2 is a cross-section in m^2. */
sonject_status smooth_trace_strips(struct smooth_trace *trace, struct tracer *tracer,
                                   struct span strips, float *real_part, float *imaginary_part);

#endif
