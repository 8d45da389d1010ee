/* Multi-bounce specular paths: the coherent echoes of several smooth faces one after the other
 * (kernels/MATH.md, "Multi-bounce specular paths"). */
#ifndef SONJECT_TRACE_MULTIBOUNCE_H
#define SONJECT_TRACE_MULTIBOUNCE_H

#include "trace/image_sources.h"
#include "trace/tracer.h"

/* Sums of echoes, which lie in few places of a large grid: tiles are made where the first one
 * comes. Integers, so the order of echoes does not matter. */
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

/* Keeps the tiles in a checkpoint that is being made, or adds up those of all that are read; NULL:
 * does nothing. Errors: INPUT, STORAGE, MEMORY. */
sonject_status multibounce_sums_share(struct multibounce_sums *sums, struct checkpoint *checkpoint);

/* Where echoes gather. */
struct multibounce_region {
    struct span strips, bins;
};

/* All echoes that the parts of an object are the first to meet. */
struct multibounce {
    struct line_grid grid;         /* the size of sub-strips and bins, as glints' are */
    struct multibounce_sums *sums; /* of each part and pair of sources; owned */
    size_t count;
    struct multibounce_region *regions; /* that hold all echoes between them; owned */
    size_t region_count;
};

/* Fills the regions from the sums: no tile lies in two. Errors: MEMORY. */
sonject_status multibounce_find_regions(struct multibounce *multibounce, struct report *report);

/* The echoes of strips.count strips of a region: complex amplitudes in m, strips.count x
 * region->bins.count, in two planes. */
void multibounce_read(const struct multibounce *multibounce,
                      const struct multibounce_region *region, struct span strips, float *real_part,
                      float *imaginary_part);

/* Whether sound from the part may meet a smooth face after it: the scene has two smooth parts, or
 * this one is smooth and not convex, and paths may have two interactions. */
bool multibounce_may_echo(const struct tracer *tracer, uint32_t part);

/* Bins of the patch where such echoes may lie, of the given size; count 0 if there are none.
 * is_own: only those by parts of the same object. */
struct span multibounce_bins(const struct tracer *tracer, uint32_t part,
                             const struct line_grid *grid, bool is_own);

/* Traces all echoes that an object's parts are the first to meet. On success to be given to
 * multibounce_end; on failure nothing is held. Errors: DEVICE, MEMORY, and the checkpoint's. */
sonject_status multibounce_begin(struct multibounce *multibounce, struct tracer *tracer,
                                 uint32_t object);
void multibounce_end(struct multibounce *multibounce);

/* The sub-strips of what a part is the first to meet, and those of the echoes; bins are each pair
 * of sources' own. */
struct multibounce_strips {
    struct line_grid grid;
    struct span first_hits;
};

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
