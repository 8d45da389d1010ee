#include "trace/corner_sums.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "kernels/tally.h"
#include "trace/image_sources.h"

bool corner_sums_init(struct corner_sums *sums, const struct line_grid *grid)
{
    sums->grid = *grid;
    sums->rows = ((size_t)grid->strips.count + TILE_STRIPS - 1) / TILE_STRIPS;
    sums->columns = ((size_t)grid->bins.count + TILE_BINS - 1) / TILE_BINS;
    sums->tiles = allocate_array(sums->rows * sums->columns, sizeof *sums->tiles);
    return sums->tiles != NULL;
}

void corner_sums_clear(struct corner_sums *sums)
{
    for (size_t i = 0; sums->tiles && i < sums->rows * sums->columns; i++)
        free(sums->tiles[i]);
    free(sums->tiles);
    memset(sums, 0, sizeof *sums);
}

/* Both parts of a cell, whose tile is made if need be; NULL where memory lacks. */
static int64_t *cell_at(struct corner_sums *sums, size_t strip, size_t bin)
{
    int64_t **tile = &sums->tiles[strip / TILE_STRIPS * sums->columns + bin / TILE_BINS];
    if (!*tile)
        *tile = allocate_array(2 * TILE_STRIPS * TILE_BINS, sizeof **tile);
    return *tile ? *tile + 2 * (strip % TILE_STRIPS * TILE_BINS + bin % TILE_BINS) : NULL;
}

bool corner_sums_add(struct corner_sums *sums, const struct corner_echo_record *echoes,
                     size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const struct corner_echo_record *echo = &echoes[i];
        const int32_t strip = echo->strip - sums->grid.strips.first;
        if (strip < 0 || strip >= sums->grid.strips.count || echo->bin < 0 ||
            echo->bin + 1 >= sums->grid.bins.count)
            continue;
        const float later = echo->fraction;
        const float sooner = 1.0f - later;
        int64_t *first = cell_at(sums, (size_t)strip, (size_t)echo->bin);
        int64_t *second = cell_at(sums, (size_t)strip, (size_t)echo->bin + 1);
        if (!first || !second)
            return false;
        first[0] += whole_quanta(echo->real_part * sooner, echo->chance);
        first[1] += whole_quanta(echo->imaginary_part * sooner, echo->chance);
        second[0] += whole_quanta(echo->real_part * later, echo->chance);
        second[1] += whole_quanta(echo->imaginary_part * later, echo->chance);
    }
    return true;
}

#define TILE_SUMS ((size_t)2 * TILE_STRIPS * TILE_BINS)

static bool add_tile(void *user, uint64_t first, const int64_t *values, size_t count)
{
    struct corner_sums *sums = user;
    if (first % TILE_SUMS != 0 || count != TILE_SUMS)
        return false;
    int64_t **tile = &sums->tiles[first / TILE_SUMS];
    if (!*tile)
        *tile = allocate_array(TILE_SUMS, sizeof **tile);
    for (size_t i = 0; i < count; i++)
        if (!*tile || !add_without_overflow(&(*tile)[i], values[i]))
            return false;
    return true;
}

sonject_status corner_sums_share(struct corner_sums *sums, struct checkpoint *checkpoint)
{
    const size_t tiles = sums->rows * sums->columns;
    if (!checkpoint)
        return SONJECT_OK;
    if (checkpoint->files)
        return checkpoint_add_up(checkpoint, (uint64_t)tiles * TILE_SUMS, add_tile, sums);
    sonject_status status =
        sums_writer_begin_sums(&checkpoint->writer, (uint64_t)tiles * TILE_SUMS);
    for (size_t i = 0; status == SONJECT_OK && i < tiles; i++)
        if (sums->tiles[i])
            status = sums_writer_run(&checkpoint->writer, (uint64_t)i * TILE_SUMS, sums->tiles[i],
                                     TILE_SUMS);
    return status == SONJECT_OK ? sums_writer_end_sums(&checkpoint->writer) : status;
}

/* Strips or bins of one tile. */
static struct span span_of_tile(size_t number, int32_t size, struct span all)
{
    const int32_t first = (int32_t)number * size;
    const struct span tile = {all.first + first, size};
    return span_overlap(tile, all);
}

void corner_sums_extent(const struct corner_sums *sums, struct span *strips, struct span *bins)
{
    strips->first = strips->count = bins->first = bins->count = 0;
    for (size_t i = 0; i < sums->rows * sums->columns; i++)
        if (sums->tiles[i]) {
            *strips =
                span_join(*strips, span_of_tile(i / sums->columns, TILE_STRIPS, sums->grid.strips));
            *bins = span_join(*bins, span_of_tile(i % sums->columns, TILE_BINS, sums->grid.bins));
        }
}

static void read_tile(const int64_t *tile, struct span rows, struct span tile_strips,
                      struct span tile_bins, double quantum, struct span strips,
                      const struct line_grid *grid, float *real_part, float *imaginary_part)
{
    for (int32_t strip = rows.first; strip < rows.first + rows.count; strip++) {
        const size_t from = (size_t)(strip - tile_strips.first) * TILE_BINS;
        const size_t to = (size_t)(strip - strips.first) * (size_t)grid->bins.count +
                          (size_t)(tile_bins.first - grid->bins.first);
        for (size_t bin = 0; bin < (size_t)tile_bins.count; bin++) {
            real_part[to + bin] += (float)((double)tile[2 * (from + bin)] * quantum);
            imaginary_part[to + bin] += (float)((double)tile[2 * (from + bin) + 1] * quantum);
        }
    }
}

void corner_sums_read(const struct corner_sums *sums, double quantum, struct span strips,
                      const struct line_grid *grid, float *real_part, float *imaginary_part)
{
    for (size_t i = 0; i < sums->rows * sums->columns; i++) {
        if (!sums->tiles[i])
            continue;
        const struct span tile_strips =
            span_of_tile(i / sums->columns, TILE_STRIPS, sums->grid.strips);
        const struct span rows = span_overlap(tile_strips, strips);
        if (rows.count > 0)
            read_tile(sums->tiles[i], rows, tile_strips,
                      span_of_tile(i % sums->columns, TILE_BINS, sums->grid.bins), quantum, strips,
                      grid, real_part, imaginary_part);
    }
}
