/* Sums of multi-bounce echoes, and the regions where they lie. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "kernels/tally.h"
#include "trace/checkpoint.h"
#include "trace/multibounce.h"

bool multibounce_sums_init(struct multibounce_sums *sums, const struct line_grid *grid)
{
    sums->grid = *grid;
    sums->rows = ((size_t)grid->strips.count + TILE_STRIPS - 1) / TILE_STRIPS;
    sums->columns = ((size_t)grid->bins.count + TILE_BINS - 1) / TILE_BINS;
    sums->tiles = allocate_array(sums->rows * sums->columns, sizeof *sums->tiles);
    return sums->tiles != NULL;
}

void multibounce_sums_clear(struct multibounce_sums *sums)
{
    for (size_t i = 0; sums->tiles && i < sums->rows * sums->columns; i++)
        free(sums->tiles[i]);
    free(sums->tiles);
    memset(sums, 0, sizeof *sums);
}

/* Returns both parts of a cell, making its tile if need be; NULL if memory lacks. */
static int64_t *cell_at(struct multibounce_sums *sums, size_t strip, size_t bin)
{
    int64_t **tile = &sums->tiles[strip / TILE_STRIPS * sums->columns + bin / TILE_BINS];
    if (!*tile)
        *tile = allocate_array(TILE_SUMS, sizeof **tile);
    return *tile ? *tile + 2 * (strip % TILE_STRIPS * TILE_BINS + bin % TILE_BINS) : NULL;
}

bool multibounce_sums_add(struct multibounce_sums *sums,
                          const struct multibounce_echo_record *echoes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const struct multibounce_echo_record *echo = &echoes[i];
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
        first[0] += whole_quanta(echo->real_part * sooner, echo->dither);
        first[1] += whole_quanta(echo->imaginary_part * sooner, echo->dither);
        second[0] += whole_quanta(echo->real_part * later, echo->dither);
        second[1] += whole_quanta(echo->imaginary_part * later, echo->dither);
    }
    return true;
}

/* Adds a run of sums, which lies in one tile. */
static bool add_run(void *user, uint64_t first, const int64_t *values, size_t count)
{
    struct multibounce_sums *sums = user;
    const size_t at = first % TILE_SUMS;
    if (count > TILE_SUMS - at)
        return false;
    int64_t **tile = &sums->tiles[first / TILE_SUMS];
    if (!*tile)
        *tile = allocate_array(TILE_SUMS, sizeof **tile);
    for (size_t i = 0; i < count; i++)
        if (!*tile || !add_without_overflow(&(*tile)[at + i], values[i]))
            return false;
    return true;
}

sonject_status multibounce_sums_share(struct multibounce_sums *sums, struct checkpoint *checkpoint)
{
    const size_t tiles = sums->rows * sums->columns;
    if (!checkpoint)
        return SONJECT_OK;
    if (checkpoint->files)
        return checkpoint_add_up(checkpoint, (uint64_t)tiles * TILE_SUMS, add_run, sums);
    sonject_status status =
        sums_writer_begin_sums(&checkpoint->writer, (uint64_t)tiles * TILE_SUMS);
    for (size_t i = 0; status == SONJECT_OK && i < tiles; i++)
        if (sums->tiles[i])
            status = sums_writer_add(&checkpoint->writer, (uint64_t)i * TILE_SUMS, sums->tiles[i],
                                     TILE_SUMS);
    return status == SONJECT_OK ? sums_writer_end_sums(&checkpoint->writer) : status;
}

/* Returns the strips or bins of one tile. */
static struct span span_of_tile(size_t number, int32_t size, struct span all)
{
    const int32_t first = (int32_t)number * size;
    const struct span tile = {all.first + first, size};
    return span_overlap(tile, all);
}

/* The cost of forming a region by itself, in cells formed. */
#define REGION_COSTS 262144.0

static double cells_of(const struct multibounce_region *region)
{
    return (double)region->strips.count * region->bins.count;
}

static bool overlap(struct span one, struct span other)
{
    return span_overlap(one, other).count > 0;
}

/* Joins two regions into the first where that costs less, or where they share cells. */
static bool join(struct multibounce_region *one, const struct multibounce_region *other)
{
    const struct multibounce_region both = {span_join(one->strips, other->strips),
                                            span_join(one->bins, other->bins)};
    if (cells_of(&both) > cells_of(one) + cells_of(other) + REGION_COSTS &&
        !(overlap(one->strips, other->strips) && overlap(one->bins, other->bins)))
        return false;
    *one = both;
    return true;
}

/* Adds a region, joined with earlier regions until none of them belongs to it. */
static void settle(struct multibounce *multibounce, struct multibounce_region region)
{
    struct multibounce_region *regions = multibounce->regions;
    for (size_t i = 0; i < multibounce->region_count;) {
        if (!join(&region, &regions[i])) {
            i++;
            continue;
        }
        regions[i] = regions[--multibounce->region_count];
        i = 0;
    }
    regions[multibounce->region_count++] = region;
}

static struct multibounce_region region_of_tile(const struct multibounce_sums *sums, size_t tile)
{
    const struct multibounce_region region = {
        span_of_tile(tile / sums->columns, TILE_STRIPS, sums->grid.strips),
        span_of_tile(tile % sums->columns, TILE_BINS, sums->grid.bins)};
    return region;
}

/* Drops tiles without an echo: shards do not keep them, and regions must not depend on shards. */
static void drop_empty_tiles(struct multibounce_sums *sums)
{
    for (size_t i = 0; i < sums->rows * sums->columns; i++) {
        size_t k = 0;
        while (sums->tiles[i] && k < TILE_SUMS && sums->tiles[i][k] == 0)
            k++;
        if (k == TILE_SUMS) {
            free(sums->tiles[i]);
            sums->tiles[i] = NULL;
        }
    }
}

sonject_status multibounce_find_regions(struct multibounce *multibounce, struct report *report)
{
    size_t tiles = 0;
    for (size_t k = 0; k < multibounce->count; k++)
        drop_empty_tiles(&multibounce->sums[k]);
    for (size_t k = 0; k < multibounce->count; k++)
        for (size_t i = 0; i < multibounce->sums[k].rows * multibounce->sums[k].columns; i++)
            tiles += multibounce->sums[k].tiles[i] != NULL;
    multibounce->regions = allocate_array(tiles, sizeof *multibounce->regions);
    CHECK_MEMORY(report, multibounce->regions, "multi-bounce echoes");
    for (size_t k = 0; k < multibounce->count; k++) {
        const struct multibounce_sums *sums = &multibounce->sums[k];
        for (size_t i = 0; i < sums->rows * sums->columns; i++)
            if (sums->tiles[i])
                settle(multibounce, region_of_tile(sums, i));
    }
    return SONJECT_OK;
}

/* Adds the echoes that a tile has in some strips and bins of a region. */
static void read_tile(const struct multibounce_sums *sums, size_t number, struct span strips,
                      struct span bins, float *real_part, float *imaginary_part)
{
    const struct multibounce_region tile = region_of_tile(sums, number);
    const struct span rows = span_overlap(tile.strips, strips);
    const struct span columns = span_overlap(tile.bins, bins);
    for (int32_t strip = rows.first; strip < rows.first + rows.count; strip++) {
        const int64_t *from =
            sums->tiles[number] + 2 * (ptrdiff_t)(strip - tile.strips.first) * TILE_BINS;
        const ptrdiff_t to = (ptrdiff_t)(strip - strips.first) * bins.count - bins.first;
        for (int32_t bin = columns.first; bin < columns.first + columns.count; bin++) {
            const int64_t *cell = from + 2 * (ptrdiff_t)(bin - tile.bins.first);
            real_part[to + bin] += (float)((double)cell[0] * sums->amplitude_of_quantum);
            imaginary_part[to + bin] += (float)((double)cell[1] * sums->amplitude_of_quantum);
        }
    }
}

/* The numbers of tiles: first...end - 1. */
struct tile_range {
    size_t first, end;
};

/* Returns the tiles that lie in some strips. */
static struct tile_range tiles_in(const struct multibounce_sums *sums, struct span strips)
{
    const struct span at = span_overlap(strips, sums->grid.strips);
    struct tile_range tiles = {0, 0};
    if (at.count > 0) {
        const int32_t first = at.first - sums->grid.strips.first;
        tiles.first = (size_t)(first / TILE_STRIPS) * sums->columns;
        tiles.end = (size_t)((first + at.count - 1) / TILE_STRIPS + 1) * sums->columns;
    }
    return tiles;
}

struct span multibounce_bins_filled(const struct multibounce *multibounce,
                                    const struct multibounce_region *region, struct span strips)
{
    struct span bins = {0, 0};
    for (size_t k = 0; k < multibounce->count; k++) {
        const struct multibounce_sums *sums = &multibounce->sums[k];
        const struct tile_range tiles = tiles_in(sums, strips);
        for (size_t i = tiles.first; i < tiles.end; i++)
            if (sums->tiles[i])
                bins = span_join(bins, span_overlap(region_of_tile(sums, i).bins, region->bins));
    }
    return bins;
}

void multibounce_read(const struct multibounce *multibounce, struct span strips, struct span bins,
                      float *real_part, float *imaginary_part)
{
    const size_t bytes = (size_t)strips.count * (size_t)bins.count * sizeof *real_part;
    memset(real_part, 0, bytes);
    memset(imaginary_part, 0, bytes);
    for (size_t k = 0; k < multibounce->count; k++) {
        const struct multibounce_sums *sums = &multibounce->sums[k];
        const struct tile_range tiles = tiles_in(sums, strips);
        for (size_t i = tiles.first; i < tiles.end; i++)
            if (sums->tiles[i])
                read_tile(sums, i, strips, bins, real_part, imaginary_part);
    }
}
