/* PNG files whose pixels are numbers of a palette's colours. OpenImageIO reads the colours; sonject
 * needs the numbers, of its own files. */
#ifndef SONJECT_SWATH_PNG_PALETTE_H
#define SONJECT_SWATH_PNG_PALETTE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/report.h"

#ifdef __cplusplus
extern "C" {
#endif

#define PNG_PALETTE_BYTES 768 /* red, green and blue of 256 numbers */

/* A coloured file is a grey one whose header has made room for these: a header that says so, the
 * palette, and the grey header, which all other readers pass over. */
#define PNG_HEADER_PLACE   8
#define PNG_HEADER_BYTES   25 /* with length, name and checksum */
#define PNG_NUMBERS_PLACE  (PNG_HEADER_PLACE + PNG_HEADER_BYTES + PNG_PALETTE_BYTES + 12 + 8)
#define PNG_COLOURED_BYTES (PNG_NUMBERS_PLACE + PNG_HEADER_BYTES + 4)

/* Writes at result the pixels of an 8 bit grey PNG as numbers of a palette's colours. name: of the
 * finished file, for messages. A result that failed is left to the caller to remove. Errors:
 * STORAGE. */
sonject_status png_colour(struct report *report, const char *grey, const uint8_t *palette,
                          const char *result, const char *name);

/* Refuses (INPUT) what OpenImageIO would give as other numbers than the file's: palettes, and
 * pixels of other than 8 and 16 bits. *is_coloured: by png_colour, so its numbers can be read. */
sonject_status png_check(struct report *report, const char *name, const char *path,
                         bool *is_coloured);

#ifdef __cplusplus
}
#endif

#endif
