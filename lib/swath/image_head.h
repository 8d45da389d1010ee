/* What the first bytes of image files say: their kind, and what of BMP, PNG and PGM files
 * OpenImageIO would not hand on as it is stored. */
#ifndef SONJECT_SWATH_IMAGE_HEAD_H
#define SONJECT_SWATH_IMAGE_HEAD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

#ifdef __cplusplus
extern "C" {
#endif

enum image_kind {
    IMAGE_TIFF,
    IMAGE_PNG,
    IMAGE_JPEG,
    IMAGE_BMP,
    IMAGE_PGM
};

/* The message for a file of no kind that sonject reads, by its first bytes. Returns INPUT. */
sonject_status image_kind_refuse(struct report *report, const char *path, const unsigned char *head,
                                 size_t count);

/* Told by bytes from a file's beginning; false for another kind. */
bool image_kind_of_beginning(const unsigned char *bytes, size_t count, enum image_kind *kind);

/* BMP and PGM have no checksums, and OpenImageIO takes what their heads say: refuses (INPUT)
 * files whose length is not what the head says, and numbers that OpenImageIO would not hand on as
 * they are stored: those of a PGM that is not of 8 bits are scaled there, so that half of a 16-bit
 * one's come out by one too small. name: of the file in messages. */
sonject_status bmp_check(struct report *report, const char *name, const char *path);
sonject_status pgm_check(struct report *report, const char *name, const char *path);

/* PNG files whose pixels are numbers of a palette's colours: OpenImageIO reads the colours; sonject
 * needs the numbers, of its own files. A coloured file is a grey one whose header has made room for
 * these: a header that says so, the palette, and the grey header in a chunk of its own, which all
 * other readers pass over. */
#define PNG_PALETTE_BYTES 768 /* red, green and blue of 256 numbers */
#define PNG_HEADER_PLACE  8
#define PNG_HEADER_BYTES  25 /* with length, name and checksum */
#define PNG_NUMBERS_PLACE (PNG_HEADER_PLACE + PNG_HEADER_BYTES + PNG_PALETTE_BYTES + 12 + 8)
#define PNG_HEAD_BYTES    (PNG_NUMBERS_PLACE + PNG_HEADER_BYTES + 4)

/* Makes the head of a coloured file of that of a grey one of 8 bits. */
void png_colour_head(const unsigned char grey[PNG_HEADER_PLACE + PNG_HEADER_BYTES],
                     const uint8_t palette[PNG_PALETTE_BYTES], unsigned char head[PNG_HEAD_BYTES]);

/* Refuses (INPUT) what OpenImageIO would give as other numbers than the file's: palettes, and
 * pixels of other than 8 and 16 bits. *is_coloured: by png_colour_head, so its numbers can be read.
 */
sonject_status png_check(struct report *report, const char *name, const char *path,
                         bool *is_coloured);

#ifdef __cplusplus
}
#endif

#endif
