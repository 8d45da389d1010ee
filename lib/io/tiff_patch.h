/* A TIFF file with some of its pixels replaced and every other byte as it was. */
#ifndef SONJECT_IO_TIFF_PATCH_H
#define SONJECT_IO_TIFF_PATCH_H

#include "base/report.h"
#include "image/raster.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reads a region's pixels, decoded. */
typedef sonject_status (*tiff_read_function)(void *user, const struct region *region, void *pixels);

struct tiff_patch {
    const char *source, *destination; /* files; the destination is made anew */
    const char *name;                 /* of the destination, for messages */
    struct region region;
    const void *pixels;      /* of the region: rows x columns x channels */
    tiff_read_function read; /* from the source */
    void *read_user;
    sonject_progress_function progress; /* may be NULL */
    void *progress_user;
};

/* Copies the file byte by byte, then replaces the region's pixels: in place where they are stored
 * plainly; else the tiles or strips that the region touches are written anew behind the end of the
 * file, and the directory is led to them. All tags, other pages and untouched blocks keep their
 * bytes. A destination that failed is left to the caller to remove. Errors: INPUT, STORAGE, MEMORY,
 * CANCELLED. */
sonject_status tiff_copy_with_patch(struct report *report, const struct tiff_patch *patch);

#ifdef __cplusplus
}
#endif

#endif
