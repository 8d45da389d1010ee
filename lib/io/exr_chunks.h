/* The chunks of rows of an OpenEXR file: one image in scanlines, stored without loss. */
#ifndef SONJECT_IO_EXR_CHUNKS_H
#define SONJECT_IO_EXR_CHUNKS_H

#include "base/report.h"
#include "image/raster.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Checks that the file is whole, before its library believes what it says of itself: each chunk is
 * where the table behind the header says, has the rows that belong there, and is neither longer
 * than they are nor shorter than compression can make them; no two share bytes for long. Errors:
 * INPUT (also as exr_header_read), MEMORY. */
sonject_status exr_check(struct report *report, const char *path);

/* Writes at result the file source with those of the chunks of the file encoded that have rows of
 * the region. encoded: an image of the same rows, channels and compression. name: of the finished
 * file, for messages. A result that failed is left to the caller to remove. Errors: INPUT, STORAGE,
 * MEMORY. */
sonject_status exr_join(struct report *report, const char *source, const char *encoded,
                        const struct region *region, const char *result, const char *name);

#ifdef __cplusplus
}
#endif

#endif
