/* The coding of a TIFF block in the making: predictor, byte order, compression. */
#ifndef SONJECT_IO_TIFF_ENCODE_H
#define SONJECT_IO_TIFF_ENCODE_H

#include <stddef.h>
#include <stdint.h>

#include "io/tiff_structure.h"

/* Codes a block of rows x structure->block_columns pixels (tiff_block_channels of them interleaved,
 * in this machine's byte order) as structure's file wants it. The result is valid for the
 * compression but saves no space: few blocks of a swath are ever replaced, and every reader reads
 * them. pixels serve as working space. Returns NULL when memory is out; else to be given to free().
 */
unsigned char *tiff_encode_block(const struct tiff_structure *structure, void *pixels,
                                 uint64_t rows, size_t *count);

/* Turns count values into the file's byte order, or back. */
void tiff_order_bytes(const struct tiff_structure *structure, void *values, size_t count);

#endif
