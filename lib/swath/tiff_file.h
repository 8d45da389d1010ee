/* TIFF files by libtiff: which of them sonject reads, and pixels that are changed in place. A part
 * of the module of image files. */
#ifndef SONJECT_SWATH_TIFF_FILE_H
#define SONJECT_SWATH_TIFF_FILE_H

#include <tiffio.h>

#include "base/report.h"
#include "image/raster.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What libtiff said first of what went wrong; all 0 before. */
struct tiff_fault {
    char message[256];
    int error; /* errno then; 0: not the system's fault */
};

/* Opens by libtiff, which prints nothing. fault stays where it is while the file is open. */
TIFF *tiff_open(const char *path, const char *mode, struct tiff_fault *fault);

/* Refuses (INPUT) a file that is cut short, and one whose pixels are not stored as sonject can read
 * and change them. Pixels are not decoded. name: in messages. */
sonject_status tiff_check(struct report *report, const char *name, const char *path);

/* Replaces the region's pixels in the file itself: tiles or strips that no longer fit in their
 * place go behind the end of the file. All tags, other pages and untouched blocks stay.
 * Errors: INPUT, STORAGE, MEMORY. */
sonject_status tiff_change(struct report *report, const char *name, const char *path,
                           const struct region *region, const void *pixels);

#ifdef __cplusplus
}
#endif

#endif
