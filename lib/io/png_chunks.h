/* The chunks of a PNG file. */
#ifndef SONJECT_IO_PNG_CHUNKS_H
#define SONJECT_IO_PNG_CHUNKS_H

#include <stdint.h>

#include "base/report.h"
#include "io/byte_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Checks that the file is whole and of a kind that sonject reads: 8 or 16 bit grey. Adds to parts
 * what a decoder needs of it: pixels and texts, whose checksums are right. What else there may be
 * would only make it print warnings. Errors: INPUT, MEMORY. */
sonject_status png_check(struct report *report, const char *path, struct byte_ranges *parts);

#define PNG_PALETTE_BYTES 768 /* red, green and blue of 256 numbers */

/* Writes at result the pixels of an 8 bit grey PNG as numbers of a palette's colours; png_check
 * gives them as grey levels again. name and result: as of png_join. Errors: STORAGE. */
sonject_status png_colour(struct report *report, const char *grey, const uint8_t *palette,
                          const char *result, const char *name);

/* Writes at result the pixels of the PNG encoded with all that the PNG source says besides: texts,
 * resolution, and chunks that only its maker knows. name: of the finished file, for messages. A
 * result that failed is left to the caller to remove. Errors: INPUT, STORAGE. */
sonject_status png_join(struct report *report, const char *source, const char *encoded,
                        const char *result, const char *name);

#ifdef __cplusplus
}
#endif

#endif
