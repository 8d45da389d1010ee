/* Sums of echoes that lie in few places of a large grid: tiles are made where the first echo comes.
 * Integers, so the order of echoes does not matter. */
#ifndef SONJECT_TRACE_CORNER_SUMS_H
#define SONJECT_TRACE_CORNER_SUMS_H

#include <stdbool.h>
#include <stddef.h>

#include "kernels/layout.h"
#include "scene/line_grid.h"
#include "trace/checkpoint.h"

#define TILE_STRIPS 16
#define TILE_BINS   256

struct corner_sums {
    struct line_grid grid;
    size_t rows, columns; /* of tiles */
    int64_t **tiles;      /* owned; NULL: nothing there; else TILE_STRIPS x TILE_BINS x (real,
                             imaginary), in quanta */
};

/* False, and nothing held, where memory lacks; else to be given to corner_sums_clear. */
bool corner_sums_init(struct corner_sums *sums, const struct line_grid *grid);
void corner_sums_clear(struct corner_sums *sums);

/* Adds echoes, each shared by the two bins about it as glints' are; bins count from the grid's
 * first. False where memory lacks. */
bool corner_sums_add(struct corner_sums *sums, const struct corner_echo_record *echoes,
                     size_t count);

/* Sums of a checkpoint: keeps the tiles that were traced, or adds up those of all checkpoints.
 * Nothing where checkpoint is NULL. Errors: INPUT, STORAGE, MEMORY. */
sonject_status corner_sums_share(struct corner_sums *sums, struct checkpoint *checkpoint);

/* The strips and bins of the tiles that there are; counts 0 where there is none. */
void corner_sums_extent(const struct corner_sums *sums, struct span *strips, struct span *bins);

/* Adds the sums of some strips, times the size of a quantum, to planes of strips.count x
 * grid->bins.count, where grid holds the extent's bins. */
void corner_sums_read(const struct corner_sums *sums, double quantum, struct span strips,
                      const struct line_grid *grid, float *real_part, float *imaginary_part);

#endif
