/* The coding of a TIFF block in the making: predictor, byte order, compression. None of libtiff's,
 * which reads it. */
#ifndef TIFF_ENCODE_H
#define TIFF_ENCODE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "image/raster.h"

enum tiff_compression {
    TIFF_UNCOMPRESSED = 1,
    TIFF_LZW = 5,
    TIFF_DEFLATE = 8,
    TIFF_PACKBITS = 32773,
    TIFF_OLD_DEFLATE = 32946
};

enum tiff_predictor {
    TIFF_PREDICTOR_DIFFERENCE = 2,
    TIFF_PREDICTOR_FLOAT = 3
};

/* Blocks are tiles, or strips: as wide as the image, and the last one may be short. */
struct tiff_structure {
    struct raster_layout layout;
    bool is_big_endian;
    bool is_tiled;
    bool is_separate; /* a plane of blocks for every channel, one after the other */
    uint32_t compression, predictor;
    uint64_t block_rows, block_columns;
    uint64_t blocks_across, blocks_down;
    uint64_t block_count; /* of all planes */
};

/* Channels that lie side by side in a block. */
uint32_t tiff_block_channels(const struct tiff_structure *structure);

/* Rows that a block holds, and what its pixels take before compression. */
uint64_t tiff_block_rows(const struct tiff_structure *structure, uint64_t block);
uint64_t tiff_block_bytes(const struct tiff_structure *structure, uint64_t block);

/* Codes a block of rows x structure->block_columns pixels (tiff_block_channels of them interleaved,
 * in this machine's byte order) as structure's file wants it. The result is valid for the
 * compression but saves no space: few blocks of a swath are ever replaced, and every reader reads
 * them. pixels serve as working space. Returns NULL when memory is out; else to be given to free().
 */
unsigned char *tiff_encode_block(const struct tiff_structure *structure, void *pixels,
                                 uint64_t rows, size_t *count);

#endif
