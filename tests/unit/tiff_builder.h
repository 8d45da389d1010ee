/* TIFF files of every build that sonject reads, made byte by byte. To be included after cmocka.h.
 */
#ifndef TIFF_BUILDER_H
#define TIFF_BUILDER_H

#include <stdlib.h>
#include <string.h>

#include "base/byte_order.h"
#include "unit/tiff_encode.h"

#define TIFF_BUILD_CAPACITY ((size_t)1 << 20)
#define TIFF_PRIVATE_TEXT   "what only the maker of this file knows"

struct tiff_build {
    struct raster_layout layout;
    bool is_big, is_big_endian, is_tiled, is_separate;
    bool shares_blocks;     /* all blocks lie in the first one's place */
    bool has_runs;          /* PackBits of rows of equal pixels */
    uint64_t last_is_later; /* the last block is said to lie so many bytes further on */
    bool has_second_page;
    uint32_t second_page_kind; /* 1: a smaller copy of the first */
    uint32_t compression, predictor;
    uint64_t block_rows, block_columns;
    /* for what is to be refused; 0: as the layout says */
    uint32_t bits, sample_format, photometric, extra_channel, fill_order;
};

struct tiff_bytes {
    const struct tiff_build *build;
    unsigned char *bytes;
    size_t count;
    uint64_t entries; /* of the directory in the making */
};

static inline void tiff_put(struct tiff_bytes *out, uint64_t number, size_t size)
{
    assert_true(out->count + size <= TIFF_BUILD_CAPACITY);
    number_to_bytes(number, out->bytes + out->count, size, out->build->is_big_endian);
    out->count += size;
}

static inline size_t tiff_wide(const struct tiff_bytes *out)
{
    return out->build->is_big ? 8 : 4;
}

static inline void tiff_put_entry(struct tiff_bytes *out, uint64_t tag, uint64_t type,
                                  uint64_t count, uint64_t value)
{
    const size_t size = type == 3 ? 2 : tiff_wide(out);
    out->entries++;
    tiff_put(out, tag, 2);
    tiff_put(out, type, 2);
    tiff_put(out, count, tiff_wide(out));
    for (size_t i = 0; i < tiff_wide(out); i += size) /* short lists of equal numbers, or one */
        tiff_put(out, i / size < count ? value : 0, size);
}

/* Rows that repeat their first byte, in runs of up to 128; returns how long that is. */
static inline size_t tiff_code_runs(const unsigned char *values, size_t row_bytes, uint64_t rows,
                                    unsigned char *coded)
{
    size_t count = 0;
    for (uint64_t row = 0; row < rows; row++)
        for (size_t i = 0; i < row_bytes; i += 128) {
            const size_t run = row_bytes - i < 128 ? row_bytes - i : 128;
            coded[count++] = (unsigned char)(257 - run);
            coded[count++] = values[row * row_bytes];
        }
    return count;
}

/* The part of pixels that a block holds, coded; returns its place. */
static inline uint64_t tiff_put_block(struct tiff_bytes *out,
                                      const struct tiff_structure *structure, uint64_t block,
                                      const unsigned char *pixels, size_t *count)
{
    const struct raster_layout *layout = &structure->layout;
    const size_t size = pixel_bytes(layout->type);
    const size_t in_block = tiff_block_channels(structure);
    const uint64_t in_plane = structure->blocks_across * structure->blocks_down;
    const size_t plane = (size_t)(block / in_plane);
    const uint64_t first_row = block % in_plane / structure->blocks_across * structure->block_rows;
    const uint64_t first_column = block % structure->blocks_across * structure->block_columns;
    unsigned char *values = calloc((size_t)tiff_block_bytes(structure, block), 1);
    assert_non_null(values);
    for (uint64_t row = 0; row < tiff_block_rows(structure, block); row++)
        for (uint64_t i = 0; i < structure->block_columns; i++)
            if (first_row + row < layout->rows && first_column + i < layout->columns)
                memcpy(values + (row * structure->block_columns + i) * in_block * size,
                       pixels + (((first_row + row) * layout->columns + first_column + i) *
                                     layout->channels +
                                 plane) *
                                    size,
                       in_block * size);
    unsigned char *coded =
        tiff_encode_block(structure, values, tiff_block_rows(structure, block), count);
    assert_non_null(coded);
    if (out->build->has_runs)
        *count = tiff_code_runs(values, (size_t)structure->block_columns * in_block * size,
                                tiff_block_rows(structure, block), coded);
    const uint64_t place = out->count;
    assert_true(out->count + *count <= TIFF_BUILD_CAPACITY);
    memcpy(out->bytes + out->count, coded, *count);
    out->count += *count;
    free(coded);
    free(values);
    return place;
}

static inline void tiff_put_directory(struct tiff_bytes *out,
                                      const struct tiff_structure *structure, uint64_t kind,
                                      uint64_t offsets, uint64_t counts)
{
    const struct tiff_build *build = out->build;
    const uint64_t place_type = build->is_big ? 16 : 4;
    const uint64_t channels = build->layout.channels;
    const uint64_t format = build->layout.type == PIXEL_FLOAT32 ? 3 : 1;
    const uint64_t bits = 8 * pixel_bytes(build->layout.type);
    const size_t head = out->count;
    const size_t head_bytes = build->is_big ? 8 : 2;
    out->entries = 0;
    tiff_put(out, 0, head_bytes);
    tiff_put_entry(out, 254, place_type, 1, kind);
    tiff_put_entry(out, 256, place_type, 1, build->layout.columns);
    tiff_put_entry(out, 257, place_type, 1, build->layout.rows);
    tiff_put_entry(out, 258, 3, channels, build->bits ? build->bits : bits);
    tiff_put_entry(out, 259, 3, 1, build->compression);
    tiff_put_entry(out, 262, 3, 1, build->photometric ? build->photometric - 1 : 1);
    if (build->fill_order)
        tiff_put_entry(out, 266, 3, 1, build->fill_order);
    if (!build->is_tiled)
        tiff_put_entry(out, 273, place_type, structure->block_count, offsets);
    tiff_put_entry(out, 277, 3, 1, channels);
    if (!build->is_tiled) {
        tiff_put_entry(out, 278, place_type, 1, build->block_rows);
        tiff_put_entry(out, 279, place_type, structure->block_count, counts);
    }
    tiff_put_entry(out, 284, 3, 1, build->is_separate ? 2 : 1);
    tiff_put_entry(out, 317, 3, 1, build->predictor);
    if (build->photometric == 1 + 3) { /* a palette of whatever the file begins with */
        out->entries++;
        tiff_put(out, 320, 2);
        tiff_put(out, 3, 2);
        tiff_put(out, 768, tiff_wide(out));
        tiff_put(out, 8, tiff_wide(out));
    }
    if (build->is_tiled) {
        tiff_put_entry(out, 322, 3, 1, build->block_columns);
        tiff_put_entry(out, 323, 3, 1, build->block_rows);
        tiff_put_entry(out, 324, place_type, structure->block_count, offsets);
        tiff_put_entry(out, 325, place_type, structure->block_count, counts);
    }
    if (channels > 1)
        tiff_put_entry(out, 338, 3, 1, build->extra_channel);
    tiff_put_entry(out, 339, 3, channels, build->sample_format ? build->sample_format : format);
    tiff_put_entry(out, 65000, 2, sizeof TIFF_PRIVATE_TEXT, 0);
    number_to_bytes(out->entries, out->bytes + head, head_bytes, build->is_big_endian);
}

static inline struct tiff_structure tiff_structure_of(const struct tiff_build *build)
{
    struct tiff_structure structure = {
        .layout = build->layout,
        .is_big_endian = build->is_big_endian,
        .is_tiled = build->is_tiled,
        .is_separate = build->is_separate && build->layout.channels > 1,
        .compression =
            build->compression == TIFF_OLD_DEFLATE ? (uint32_t)TIFF_DEFLATE : build->compression,
        .predictor = build->predictor,
        .block_rows = build->block_rows,
        .block_columns = build->is_tiled ? build->block_columns : build->layout.columns};
    structure.blocks_across = (build->layout.columns - 1) / structure.block_columns + 1;
    structure.blocks_down = (build->layout.rows - 1) / structure.block_rows + 1;
    structure.block_count = structure.blocks_across * structure.blocks_down *
                            (structure.is_separate ? build->layout.channels : 1);
    return structure;
}

/* A file with these pixels, for free(). */
static inline unsigned char *build_tiff(const struct tiff_build *build, const void *pixels,
                                        size_t *count)
{
    const struct tiff_structure structure = tiff_structure_of(build);
    struct tiff_bytes out = {build, calloc(TIFF_BUILD_CAPACITY, 1), 0, 0};
    uint64_t *places = calloc((size_t)structure.block_count, sizeof *places);
    size_t *counts = calloc((size_t)structure.block_count, sizeof *counts);
    assert_true(out.bytes && places && counts);
    memcpy(out.bytes, build->is_big_endian ? "MM" : "II", 2);
    out.count = 2;
    tiff_put(&out, build->is_big ? 43 : 42, 2);
    if (build->is_big)
        tiff_put(&out, build->is_big_endian ? 0x80000 : 8, 4);
    const size_t first_directory = out.count;
    tiff_put(&out, 0, tiff_wide(&out));
    for (uint64_t i = 0; i < structure.block_count; i++) {
        places[i] = tiff_put_block(&out, &structure, i, pixels, &counts[i]);
        if (build->shares_blocks)
            places[i] = places[0];
    }
    places[structure.block_count - 1] += build->last_is_later;
    out.count += out.count % 2;
    const bool is_list = structure.block_count > 1; /* else its number stands in the entry */
    const uint64_t place_list = is_list ? out.count : places[0];
    for (uint64_t i = 0; i < structure.block_count; i++)
        tiff_put(&out, places[i], tiff_wide(&out));
    const uint64_t count_list = is_list ? out.count : counts[0];
    for (uint64_t i = 0; i < structure.block_count; i++)
        tiff_put(&out, counts[i], tiff_wide(&out));
    number_to_bytes(out.count, out.bytes + first_directory, tiff_wide(&out), build->is_big_endian);
    tiff_put_directory(&out, &structure, 0, place_list, count_list);
    size_t text_entries[2] = {out.count - tiff_wide(&out), out.count - tiff_wide(&out)};
    if (build->has_second_page) {
        tiff_put(&out, out.count + tiff_wide(&out), tiff_wide(&out));
        tiff_put_directory(&out, &structure, build->second_page_kind, place_list, count_list);
        text_entries[1] = out.count - tiff_wide(&out);
    }
    tiff_put(&out, 0, tiff_wide(&out));
    for (int i = 0; i < 2; i++) /* the last entry's value */
        number_to_bytes(out.count, out.bytes + text_entries[i], tiff_wide(&out),
                        build->is_big_endian);
    memcpy(out.bytes + out.count, TIFF_PRIVATE_TEXT, sizeof TIFF_PRIVATE_TEXT);
    out.count += sizeof TIFF_PRIVATE_TEXT;
    free(places);
    free(counts);
    *count = out.count;
    return out.bytes;
}

#endif
