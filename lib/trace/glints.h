/* The coherent part: one object's glints by physical optics, sub-strip by sub-strip. Those that go
 * straight, by image sources and by further smooth faces interfere: there is one trace for each
 * pair of sources, and all are added up on one grid. */
#ifndef SONJECT_TRACE_GLINTS_H
#define SONJECT_TRACE_GLINTS_H

#include "trace/image_sources.h"
#include "trace/tracer.h"

#define GLINT_CELL_WAVELENGTHS 0.125 /* spacing of rays on the wavefront */

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

/* Rays of a fan, whose strips are known, from a source to a part; `finer` than glints need them by
 * that factor each way, >= 1. */
void glint_fan_init(struct fan_record *fan, const struct tracer *tracer, uint32_t part,
                    const struct ray_path *path, double finer);

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

/* Multi-bounce specular paths: echoes of several smooth faces one after the other, the first of
 * which is a given part. Their sums lie in few places of a large grid: tiles are made where the
 * first echo comes. Integers, so the order of echoes does not matter. */
#define TILE_STRIPS 16
#define TILE_BINS   256
#define TILE_SUMS   ((size_t)2 * TILE_STRIPS * TILE_BINS)

struct multibounce_sums {
    struct line_grid grid;
    size_t rows, columns; /* of tiles */
    int64_t **tiles;      /* owned; NULL: nothing there; else TILE_STRIPS x TILE_BINS x (real,
                             imaginary), in quanta */
    double amplitude_of_quantum; /* m */
};

/* False, and nothing held, where memory lacks; else to be given to multibounce_sums_clear. */
bool multibounce_sums_init(struct multibounce_sums *sums, const struct line_grid *grid);
void multibounce_sums_clear(struct multibounce_sums *sums);

/* Adds echoes, each shared by the two bins about it as glints' are; bins count from the grid's
 * first. False where memory lacks. */
bool multibounce_sums_add(struct multibounce_sums *sums,
                          const struct multibounce_echo_record *echoes, size_t count);

/* The echoes that a part is the first to meet. */
struct multibounce {
    struct line_grid grid;         /* that holds all echoes; as glints' are; no strips: no echoes */
    struct span first_hits;        /* sub-strips that the part covers */
    struct multibounce_sums *sums; /* of each pair of sources; owned */
    size_t count;
};

/* Whether sound from the part may meet a smooth face after it: the scene has two smooth parts, or
 * this one is smooth and not convex, and paths may have two interactions. */
bool multibounce_may_echo(const struct tracer *tracer, uint32_t part);

/* Bins of the patch where such echoes may lie, of the given size; count 0 if there are none. */
struct span multibounce_bins(const struct tracer *tracer, uint32_t part,
                             const struct line_grid *grid);

/* Traces all echoes that a part is the first to meet. On success to be given to multibounce_end; on
 * failure nothing is held. Errors: DEVICE, MEMORY. */
sonject_status multibounce_begin(struct multibounce *multibounce, struct tracer *tracer,
                                 uint32_t part);
void multibounce_end(struct multibounce *multibounce);

/* Adds the echoes of strips, complex amplitudes in m, to planes of strips.count x grid->bins.count.
 */
void multibounce_add(const struct multibounce *multibounce, struct span strips,
                     const struct line_grid *grid, float *real_part, float *imaginary_part);

/* The launch's buffers. */
enum multibounce_buffer {
    MULTIBOUNCE_OBJECTS,
    MULTIBOUNCE_SOURCES,
    MULTIBOUNCE_RECORD,
    MULTIBOUNCE_ECHOES,
    MULTIBOUNCE_LISTED
};

/* The echoes of one pair of sources. */
struct multibounce_launch {
    struct launch launch;
    struct multibounce_record record;
    struct image_pair_record sources;
    size_t capacity; /* of echoes */
    int32_t chunk;   /* sub-strips whose echoes fit that */
};

/* The steps of multibounce_begin: the grid of one pair's echoes and its launch, whose echoes are
 * listed chunk by chunk of first hits. The grid's bins.count is 0, and nothing is held, where there
 * can be none; else to be given to multibounce_launch_end. */
void multibounce_init(struct multibounce *multibounce, const struct tracer *tracer, uint32_t part);
sonject_status multibounce_launch_begin(struct multibounce_launch *of_pair, struct line_grid *grid,
                                        const struct multibounce *multibounce,
                                        struct tracer *tracer, uint32_t part,
                                        const struct image_pair *pair);
void multibounce_launch_end(struct multibounce_launch *of_pair);

/* Adds the echoes of first hits in strips.count <= chunk sub-strips to the sums. */
sonject_status multibounce_launch_strips(struct multibounce_launch *of_pair, struct tracer *tracer,
                                         struct span strips, struct multibounce_sums *sums);

struct glints {
    struct line_grid grid;       /* that holds every trace's strips and bins */
    struct smooth_trace *traces; /* owned; the straight one is the first */
    size_t count;
    int32_t chunk;                     /* sub-strips that a call of glints_trace may take */
    struct multibounce multibounce;    /* owned */
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
