/* The boxes of a JPEG 2000 file (.jp2), or a coded image without any (.j2k, .j2c). */
#ifndef SONJECT_IO_JP2_BOXES_H
#define SONJECT_IO_JP2_BOXES_H

#include "base/report.h"
#include "io/byte_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Checks that the file is whole, of a kind that sonject reads (one component of 8 or 16 bit
 * unsigned, no palette), and that its head and its coded image say the same. Adds to parts what a
 * decoder needs of it: the coded image, as jp2_codestream_check knows it. Errors: INPUT, MEMORY. */
sonject_status jp2_check(struct report *report, const char *path, struct byte_ranges *parts);

/* Writes at result the coded image of the file encoded with all the boxes that the file source has
 * around its own: colours, resolution, places, notes. name: of the finished file, for messages. A
 * result that failed is left to the caller to remove. Errors: INPUT, STORAGE, MEMORY. */
sonject_status jp2_join(struct report *report, const char *source, const char *encoded,
                        const char *result, const char *name);

#ifdef __cplusplus
}
#endif

#endif
