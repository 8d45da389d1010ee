/* The segments of a JPEG file. */
#ifndef SONJECT_IO_JPEG_SEGMENTS_H
#define SONJECT_IO_JPEG_SEGMENTS_H

#include "base/report.h"
#include "io/byte_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Checks that the file is whole, of a kind that sonject reads (8 bit grey), and not so much larger
 * when decoded that it must be damaged. Adds to parts what a decoder needs of it: pixels and
 * comments. Errors: INPUT, MEMORY. */
sonject_status jpeg_check(struct report *report, const char *path, struct byte_ranges *parts);

/* Writes at result the pixels of the JPEG encoded with all that the JPEG source says besides: EXIF,
 * comments and other notes. name: of the finished file, for messages. A result that failed is left
 * to the caller to remove. Errors: INPUT, STORAGE. */
sonject_status jpeg_join(struct report *report, const char *source, const char *encoded,
                         const char *result, const char *name);

#ifdef __cplusplus
}
#endif

#endif
