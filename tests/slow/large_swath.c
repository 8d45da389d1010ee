/* A patch put into a swath of 6 GB, with peak memory below 512 MB. To be run by hand, as it needs
 * 13 GB of disk: large_swath FOLDER [none|deflate]. Leaves nothing in the folder. */
#define _POSIX_C_SOURCE 200809L
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/byte_order.h"
#include "swath/raster_file.h"
#include "swath/swath_file.h"
#include "unit/tiff_encode.h"

#define ROWS       UINT64_C(65536)
#define COLUMNS    UINT64_C(49152)
#define TILE       UINT64_C(256)
#define ENTRIES    11
#define HEAD_BYTES (16 + 8 + ENTRIES * 20 + 8)
#define LIMIT_MB   512

static uint16_t pixel_at(uint64_t row, uint64_t column)
{
    return (uint16_t)((row * 40503u ^ column * 30011u) >> 3);
}

static void fail(const char *what, const char *why)
{
    fprintf(stderr, "large_swath: %s: %s\n", what, why);
    exit(1);
}

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void put(FILE *file, uint64_t number, size_t size)
{
    unsigned char bytes[8];
    number_to_bytes(number, bytes, size, false);
    if (fwrite(bytes, 1, size, file) != size)
        fail("writing", "disk full?");
}

static void put_entry(FILE *file, uint64_t tag, uint64_t type, uint64_t count, uint64_t value)
{
    put(file, tag, 2);
    put(file, type, 2);
    put(file, count, 8);
    put(file, value, 8);
}

/* Every coded tile is equally long, so all places are known before. */
static void write_head(FILE *file, const struct tiff_structure *structure, uint64_t tile_bytes)
{
    const uint64_t tiles = structure->block_count;
    fwrite("II", 1, 2, file);
    put(file, 43, 2);
    put(file, 8, 4);
    put(file, 16, 8);
    put(file, ENTRIES, 8);
    put_entry(file, 256, 4, 1, COLUMNS);
    put_entry(file, 257, 4, 1, ROWS);
    put_entry(file, 258, 3, 1, 16);
    put_entry(file, 259, 3, 1, structure->compression);
    put_entry(file, 262, 3, 1, 1);
    put_entry(file, 277, 3, 1, 1);
    put_entry(file, 284, 3, 1, 1);
    put_entry(file, 322, 3, 1, TILE);
    put_entry(file, 323, 3, 1, TILE);
    put_entry(file, 324, 16, tiles, HEAD_BYTES);
    put_entry(file, 325, 16, tiles, HEAD_BYTES + tiles * 8);
    put(file, 0, 8);
    for (uint64_t i = 0; i < tiles; i++)
        put(file, HEAD_BYTES + tiles * 16 + i * tile_bytes, 8);
    for (uint64_t i = 0; i < tiles; i++)
        put(file, tile_bytes, 8);
}

static void write_swath(const char *path, uint32_t compression)
{
    const struct tiff_structure structure = {.layout = {ROWS, COLUMNS, 1, PIXEL_UINT16},
                                             .is_tiled = true,
                                             .compression = compression,
                                             .predictor = 1,
                                             .block_rows = TILE,
                                             .block_columns = TILE,
                                             .blocks_across = COLUMNS / TILE,
                                             .blocks_down = ROWS / TILE,
                                             .block_count = COLUMNS / TILE * (ROWS / TILE)};
    static uint16_t tile[TILE * TILE];
    FILE *file = fopen(path, "wb");
    if (!file)
        fail(path, "cannot be written");
    for (uint64_t i = 0; i < structure.block_count; i++) {
        size_t count = 0;
        for (uint64_t row = 0; row < TILE; row++)
            for (uint64_t column = 0; column < TILE; column++)
                tile[row * TILE + column] = pixel_at(i / structure.blocks_across * TILE + row,
                                                     i % structure.blocks_across * TILE + column);
        unsigned char *coded = tiff_encode_block(&structure, tile, TILE, &count);
        if (!coded)
            fail(path, "out of memory");
        if (i == 0)
            write_head(file, &structure, count);
        if (fwrite(coded, 1, count, file) != count)
            fail(path, "cannot be written");
        free(coded);
    }
    if (fclose(file) != 0)
        fail(path, "cannot be written");
}

/* The copy's pixels in a window around the patch, and in windows all over the swath. */
static void check_window(struct swath_file *file, const struct region *window,
                         const struct region *patch)
{
    struct report report = {{0}, NULL, NULL};
    uint16_t *pixels = calloc((size_t)(window->rows * window->columns), sizeof *pixels);
    if (!pixels)
        fail("checking", "out of memory");
    if (swath_file_read(&report, file, window, pixels) != SONJECT_OK)
        fail("checking", report.message);
    for (uint64_t i = 0; i < window->rows * window->columns; i++) {
        const uint64_t row = window->first_row + i / window->columns;
        const uint64_t column = window->first_column + i % window->columns;
        const bool is_patch = row >= patch->first_row && row < patch->first_row + patch->rows &&
                              column >= patch->first_column &&
                              column < patch->first_column + patch->columns;
        const uint16_t was = pixel_at(row, column);
        if (pixels[i] != (is_patch ? (uint16_t)~was : was))
            fail("checking", "a pixel of the copy is wrong");
    }
    free(pixels);
}

static void check_copy(const char *path, const struct region *patch)
{
    struct report report = {{0}, NULL, NULL};
    struct swath_file *file;
    const struct region around = {patch->first_row - 100, patch->first_column - 100,
                                  patch->rows + 200, patch->columns + 200};
    if (swath_file_open_array(&report, path, SONJECT_CHANNEL_ONLY, NULL, &file) != SONJECT_OK)
        fail("checking", report.message);
    check_window(file, &around, patch);
    for (uint64_t row = 0; row + 300 < ROWS; row += 5003)
        for (uint64_t column = 0; column + 300 < COLUMNS; column += 7001) {
            const struct region window = {row, column, 300, 300};
            check_window(file, &window, patch);
        }
    swath_file_close(&file);
}

static void put_patch(const char *source, const char *copy, const struct region *patch)
{
    struct report report = {{0}, NULL, NULL};
    uint16_t *pixels = calloc((size_t)(patch->rows * patch->columns), sizeof *pixels);
    if (!pixels)
        fail(copy, "out of memory");
    for (uint64_t i = 0; i < patch->rows * patch->columns; i++)
        pixels[i] = (uint16_t)~pixel_at(patch->first_row + i / patch->columns,
                                        patch->first_column + i % patch->columns);
    struct swath_file *file;
    if (swath_file_open_array(&report, source, SONJECT_CHANNEL_ONLY, NULL, &file) != SONJECT_OK ||
        swath_file_copy_with_patch(&report, file, copy, patch, pixels, NULL, NULL) != SONJECT_OK)
        fail(copy, report.message);
    swath_file_close(&file);
    free(pixels);
}

static void put_mask(const char *mask, const struct region *patch)
{
    struct report report = {{0}, NULL, NULL};
    const struct raster_layout layout = {ROWS, COLUMNS, 1, PIXEL_UINT8};
    unsigned char *pixels = calloc((size_t)(patch->rows * patch->columns), 1);
    if (!pixels)
        fail(mask, "out of memory");
    memset(pixels, 255, (size_t)(patch->rows * patch->columns));
    if (raster_file_write_placed(&report, mask, &layout, patch, pixels, NULL) != SONJECT_OK)
        fail(mask, report.message);
    free(pixels);
}

static double gigabytes(const char *path)
{
    struct stat facts;
    return stat(path, &facts) == 0 ? (double)facts.st_size / 1e9 : 0.0;
}

int main(int count, char **arguments)
{
    char source[4096];
    char copy[4096];
    char mask[4096];
    struct rusage usage;
    const struct region patch = {40123, 20345, 512, 512};
    const bool is_deflate = count == 3 && strcmp(arguments[2], "deflate") == 0;
    if (count < 2 || count > 3)
        fail("usage", "large_swath FOLDER [none|deflate]");
    snprintf(source, sizeof source, "%s/large_swath_source.tif", arguments[1]);
    snprintf(copy, sizeof copy, "%s/large_swath_copy.tif", arguments[1]);
    snprintf(mask, sizeof mask, "%s/large_swath_mask.png", arguments[1]);
    double start = seconds();
    write_swath(source, is_deflate ? TIFF_DEFLATE : TIFF_UNCOMPRESSED);
    printf("swath of %.2f GB made in %.1f s\n", gigabytes(source), seconds() - start);
    start = seconds();
    put_patch(source, copy, &patch);
    printf("copied with its patch in %.1f s\n", seconds() - start);
    check_copy(copy, &patch);
    (void)unlink(source);
    (void)unlink(copy);
    start = seconds();
    put_mask(mask, &patch);
    printf("mask of %.3f GB written in %.1f s\n", gigabytes(mask), seconds() - start);
    (void)unlink(mask);
    getrusage(RUSAGE_SELF, &usage);
    printf("peak memory %ld MB (limit %d)\n", usage.ru_maxrss / 1024, LIMIT_MB);
    return usage.ru_maxrss / 1024 < LIMIT_MB ? 0 : 1;
}
