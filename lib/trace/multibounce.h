/* Multi-bounce specular paths: the coherent echoes of several smooth faces one after the other
 * (kernels/MATH.md, "Multi-bounce specular paths"). */
#ifndef SONJECT_TRACE_MULTIBOUNCE_H
#define SONJECT_TRACE_MULTIBOUNCE_H

#include "trace/image_sources.h"
#include "trace/tracer.h"

/* Sums of echoes, which lie in few places of a large grid. A tile is made where its first echo
 * comes. Sums are integers, so the order of echoes does not matter. */
#define TILE_STRIPS 16
#define TILE_BINS   256
#define TILE_SUMS   ((size_t)2 * TILE_STRIPS * TILE_BINS)

struct multibounce_sums {
    struct line_grid grid;
    size_t rows, columns; /* tiles of the grid */
    int64_t **tiles; /* owned; NULL: none; quanta, TILE_STRIPS x TILE_BINS x (real, imaginary) */
    double amplitude_of_quantum; /* m */
};

/* Makes empty sums for multibounce_sums_clear. Returns false, holding nothing, if memory lacks. */
bool multibounce_sums_init(struct multibounce_sums *sums, const struct line_grid *grid);
void multibounce_sums_clear(struct multibounce_sums *sums);

/* Adds echoes, each shared like a glint by the two bins about it. Bins count from the grid's first.
 * Returns false if memory lacks. */
bool multibounce_sums_add(struct multibounce_sums *sums,
                          const struct multibounce_echo_record *echoes, size_t count);

/* Keeps the tiles in a checkpoint that is being made, or adds up those of all that are read. Does
 * nothing if the checkpoint is NULL. Errors: INPUT, STORAGE, MEMORY. */
sonject_status multibounce_sums_share(struct multibounce_sums *sums, struct checkpoint *checkpoint);

/* A rectangle where echoes gather. */
struct multibounce_region {
    struct span strips, bins;
};

/* All echoes whose first hit is on a part of an object. */
struct multibounce {
    struct line_grid grid;         /* sub-strips and bins have the size of the glints' */
    struct multibounce_sums *sums; /* sums of each part and pair of sources; owned */
    size_t count;
    struct multibounce_region *regions; /* regions that hold all echoes between them; owned */
    size_t region_count;
};

/* Finds the regions of the sums; no tile lies in two of them. Errors: MEMORY. */
sonject_status multibounce_find_regions(struct multibounce *multibounce, struct report *report);

/* Returns the bins of a region that may hold echoes in some of its strips; count 0: there are none.
 */
struct span multibounce_bins_filled(const struct multibounce *multibounce,
                                    const struct multibounce_region *region, struct span strips);

/* Reads the echoes of some strips and bins into two planes of strips.count x bins.count: complex
 * amplitudes, m. */
void multibounce_read(const struct multibounce *multibounce, struct span strips, struct span bins,
                      float *real_part, float *imaginary_part);

/* Returns whether sound from the part may meet a smooth face after it. The part must be smooth,
 * with a second smooth part in the scene or not convex, and paths may have two interactions. */
bool multibounce_may_echo(const struct tracer *tracer, uint32_t part);

/* Returns the bins of the patch, of the given size, where such echoes may lie; count 0 if there are
 * none. is_own: only echoes by way of parts of the same object. */
struct span multibounce_bins(const struct tracer *tracer, uint32_t part,
                             const struct line_grid *grid, bool is_own);

/* Traces all echoes whose first hit is on a part of the object. After success the caller calls
 * multibounce_end; on failure nothing is held. Errors: DEVICE, MEMORY, and the checkpoint's. */
sonject_status multibounce_begin(struct multibounce *multibounce, struct tracer *tracer,
                                 uint32_t object);
void multibounce_end(struct multibounce *multibounce);

/* The sub-strips of a part's first hits, and of the echoes. Bins are each pair of sources' own. */
struct multibounce_strips {
    struct line_grid grid;
    struct span first_hits;
};

/* The echoes of one pair of sources. */
struct multibounce_launch {
    struct launch launch;
    struct multibounce_record record;
    struct image_pair_record sources;
    size_t capacity; /* echoes that fit */
    int32_t chunk;   /* sub-strips whose echoes fit */
};

/* The steps of multibounce_begin: the grid of one pair's echoes and its launch, which lists echoes
 * chunk by chunk of first hits. Where there can be none, the grid's bins.count is 0 and nothing is
 * held. Otherwise the caller calls multibounce_launch_end. */
void multibounce_strips_init(struct multibounce_strips *strips, const struct tracer *tracer,
                             uint32_t part);
sonject_status multibounce_launch_begin(struct multibounce_launch *of_pair, struct line_grid *grid,
                                        const struct multibounce_strips *of_part,
                                        struct tracer *tracer, uint32_t part,
                                        const struct image_pair *pair);
void multibounce_launch_end(struct multibounce_launch *of_pair);

/* Adds the echoes of first hits in strips.count <= chunk sub-strips to the sums. */
sonject_status multibounce_launch_strips(struct multibounce_launch *of_pair, struct tracer *tracer,
                                         struct span strips, struct multibounce_sums *sums);

#endif
