/* Where the first image of a TIFF or BigTIFF file keeps its pixels: enough to replace some of them
 * without touching anything else in the file. */
#ifndef SONJECT_IO_TIFF_STRUCTURE_H
#define SONJECT_IO_TIFF_STRUCTURE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/report.h"
#include "image/raster.h"

#ifdef __cplusplus
extern "C" {
#endif

enum tiff_compression {
    TIFF_UNCOMPRESSED = 1,
    TIFF_LZW = 5,
    TIFF_DEFLATE = 8,
    TIFF_PACKBITS = 32773,
    TIFF_OLD_DEFLATE = 32946
};

enum tiff_predictor {
    TIFF_PREDICTOR_NONE = 1,
    TIFF_PREDICTOR_DIFFERENCE = 2,
    TIFF_PREDICTOR_FLOAT = 3
};

/* Blocks are tiles or strips: strips are blocks as wide as the image whose last one may be short.
 */
struct tiff_structure {
    struct raster_layout layout;
    uint64_t file_bytes;
    bool is_big; /* BigTIFF: places are 64 bits wide */
    bool is_big_endian;
    bool is_tiled;
    bool is_separate; /* a plane of blocks for every channel, one after the other */
    uint32_t compression, predictor;
    uint64_t block_rows, block_columns;
    uint64_t blocks_across, blocks_down;
    uint64_t block_count; /* of all planes */
    uint64_t *offsets, *counts;
    uint64_t offsets_entry, counts_entry; /* places of the directory's entries that list these */
};

/* Reads and checks the structure; everything that it lists lies inside the file. On failure nothing
 * is left to clear. Errors: INPUT (damaged, cut short, or of a kind that sonject does not read),
 * STORAGE, MEMORY. */
sonject_status tiff_structure_read(struct report *report, const char *path,
                                   struct tiff_structure *structure);
void tiff_structure_clear(struct tiff_structure *structure);

/* Channels that lie side by side in a block: 1 if every channel has blocks of its own. */
uint32_t tiff_block_channels(const struct tiff_structure *structure);

/* Rows that a block holds, and what its pixels take before compression. */
uint64_t tiff_block_rows(const struct tiff_structure *structure, uint64_t block);
uint64_t tiff_block_bytes(const struct tiff_structure *structure, uint64_t block);

#ifdef __cplusplus
}
#endif

#endif
