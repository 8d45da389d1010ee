#include "unit/tiff_encode.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/byte_order.h"
#include "base/memory.h"

/* Compressed bytes as they grow. */
struct coded {
    unsigned char *bytes;
    size_t count;
    uint32_t bits; /* of LZW codes, not yet a byte */
    int bit_count;
};

uint32_t tiff_block_channels(const struct tiff_structure *structure)
{
    return structure->is_separate ? 1 : structure->layout.channels;
}

uint64_t tiff_block_rows(const struct tiff_structure *structure, uint64_t block)
{
    const uint64_t down = block / structure->blocks_across % structure->blocks_down;
    const uint64_t left = structure->layout.rows - down * structure->block_rows;
    return structure->is_tiled || left > structure->block_rows ? structure->block_rows : left;
}

uint64_t tiff_block_bytes(const struct tiff_structure *structure, uint64_t block)
{
    return tiff_block_rows(structure, block) * structure->block_columns *
           tiff_block_channels(structure) * pixel_bytes(structure->layout.type);
}

static void order_bytes(const struct tiff_structure *structure, void *values, size_t count)
{
    const size_t size = pixel_bytes(structure->layout.type);
    unsigned char *value = values;
    if (structure->is_big_endian == machine_is_big_endian())
        return;
    for (size_t i = 0; i < count; i++, value += size)
        for (size_t j = 0; j < size / 2; j++) {
            const unsigned char kept = value[j];
            value[j] = value[size - 1 - j];
            value[size - 1 - j] = kept;
        }
}

/* Each value less its left neighbour of the same channel, as integers that wrap. */
static void subtract_neighbours(unsigned char *row, size_t values, size_t size, size_t channels)
{
    const bool is_big_endian = machine_is_big_endian();
    for (size_t i = values; i-- > channels;) {
        unsigned char *here = row + i * size;
        const uint64_t difference = number_from_bytes(here, size, is_big_endian) -
                                    number_from_bytes(here - channels * size, size, is_big_endian);
        number_to_bytes(difference, here, size, is_big_endian);
    }
}

/* All first bytes of the floats of a row, then all second ones, ..., highest first. */
static void sort_bytes(unsigned char *row, size_t values, unsigned char *scratch)
{
    const bool is_big_endian = machine_is_big_endian();
    memcpy(scratch, row, values * sizeof(float));
    for (size_t i = 0; i < values; i++)
        for (size_t j = 0; j < sizeof(float); j++)
            row[j * values + i] =
                scratch[i * sizeof(float) + (is_big_endian ? j : sizeof(float) - 1 - j)];
}

/* False when memory is out. */
static bool predict(const struct tiff_structure *structure, unsigned char *pixels, uint64_t rows)
{
    const size_t channels = tiff_block_channels(structure);
    const size_t values = (size_t)structure->block_columns * channels;
    const size_t size = pixel_bytes(structure->layout.type);
    if (structure->predictor != TIFF_PREDICTOR_FLOAT) {
        if (structure->predictor == TIFF_PREDICTOR_DIFFERENCE)
            for (uint64_t row = 0; row < rows; row++)
                subtract_neighbours(pixels + row * values * size, values, size, channels);
        order_bytes(structure, pixels, (size_t)rows * values);
        return true;
    }
    unsigned char *scratch = allocate_array(values, size);
    if (!scratch)
        return false;
    for (uint64_t row = 0; row < rows; row++) {
        sort_bytes(pixels + row * values * size, values, scratch);
        subtract_neighbours(pixels + row * values * size, values * size, 1, channels);
    }
    free(scratch);
    return true;
}

static void put(struct coded *coded, const unsigned char *bytes, size_t count)
{
    memcpy(coded->bytes + coded->count, bytes, count);
    coded->count += count;
}

/* A zlib stream of blocks that are stored as they are. */
static void store_deflate(struct coded *coded, const unsigned char *bytes, size_t count)
{
    static const unsigned char head[2] = {0x78, 0x01};
    uint32_t low = 1; /* of the Adler-32 checksum */
    uint32_t high = 0;
    put(coded, head, sizeof head);
    for (size_t start = 0; start < count || start == 0; start += 65535) {
        const size_t some = count - start < 65535 ? count - start : 65535;
        unsigned char block[5] = {start + some == count};
        number_to_bytes(some, block + 1, 2, false);
        number_to_bytes(~(uint64_t)some, block + 3, 2, false);
        put(coded, block, sizeof block);
        put(coded, bytes + start, some);
    }
    for (size_t i = 0; i < count; i++) {
        low = (low + bytes[i]) % 65521;
        high = (high + low) % 65521;
    }
    number_to_bytes((uint64_t)high << 16 | low, coded->bytes + coded->count, 4, true);
    coded->count += 4;
}

static void put_code(struct coded *coded, uint32_t code)
{
    coded->bits = coded->bits << 9 | code;
    coded->bit_count += 9;
    while (coded->bit_count >= 8) {
        coded->bit_count -= 8;
        coded->bytes[coded->count++] = (unsigned char)(coded->bits >> coded->bit_count & 0xFF);
    }
}

/* Codes of single bytes. The table is cleared before it would make codes wider than 9 bits. */
static void store_lzw(struct coded *coded, const unsigned char *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (i % 200 == 0)
            put_code(coded, 256);
        put_code(coded, bytes[i]);
    }
    put_code(coded, 257);
    put_code(coded, 0); /* fills the last byte; nothing is read behind the end code */
}

/* Runs of bytes that stand for themselves, none across the end of a row. */
static void store_packbits(struct coded *coded, const unsigned char *bytes, size_t row_bytes,
                           uint64_t rows)
{
    for (uint64_t row = 0; row < rows; row++)
        for (size_t i = 0; i < row_bytes; i += 128) {
            const size_t some = row_bytes - i < 128 ? row_bytes - i : 128;
            coded->bytes[coded->count++] = (unsigned char)(some - 1);
            put(coded, bytes + row * row_bytes + i, some);
        }
}

unsigned char *tiff_encode_block(const struct tiff_structure *structure, void *pixels,
                                 uint64_t rows, size_t *count)
{
    const size_t row_bytes = (size_t)structure->block_columns * tiff_block_channels(structure) *
                             pixel_bytes(structure->layout.type);
    const size_t bytes = row_bytes * (size_t)rows;
    struct coded coded = {0};
    /* LZW adds an eighth and a code every 200 bytes, PackBits a byte every row and 128 bytes */
    coded.bytes = allocate_array(bytes + bytes / 4 + (size_t)rows + 64, 1);
    if (!coded.bytes || !predict(structure, pixels, rows)) {
        free(coded.bytes);
        return NULL;
    }
    if (structure->compression == TIFF_DEFLATE)
        store_deflate(&coded, pixels, bytes);
    else if (structure->compression == TIFF_LZW)
        store_lzw(&coded, pixels, bytes);
    else if (structure->compression == TIFF_PACKBITS)
        store_packbits(&coded, pixels, row_bytes, rows);
    else
        put(&coded, pixels, bytes);
    *count = coded.count;
    return coded.bytes;
}
