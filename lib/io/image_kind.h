/* Which kind of image a file is, and whether it is whole. */
#ifndef SONJECT_IO_IMAGE_KIND_H
#define SONJECT_IO_IMAGE_KIND_H

#include <stdbool.h>

#include "base/report.h"
#include "io/byte_file.h"

#ifdef __cplusplus
extern "C" {
#endif

enum image_kind {
    IMAGE_TIFF,
    IMAGE_PNG,
    IMAGE_JPEG,
    IMAGE_OPENEXR,
    IMAGE_BMP,
    IMAGE_PNM /* PGM and PFM */
};

/* Whether a copy keeps the format, with other pixels in a region; else copies are TIFF. */
bool image_kind_is_patched(enum image_kind kind);

/* Told by the file's first bytes. Errors: INPUT (cannot be opened, another kind). */
sonject_status image_kind_of(struct report *report, const char *path, enum image_kind *kind);

/* Told by bytes from a file's beginning; false for another kind. */
bool image_kind_of_beginning(const unsigned char *bytes, size_t count, enum image_kind *kind);

/* Told by the extension of a file that is to be written; false for another kind. */
bool image_kind_of_name(const char *path, enum image_kind *kind);

/* Checks but for TIFF what can be told without decoding: that the file is not cut short, and that its pixels are
 * of a kind that sonject reads. Adds to parts what a decoder needs of the file; nothing if it needs
 * all. Errors: INPUT, STORAGE, MEMORY. */
sonject_status image_kind_check(struct report *report, const char *path, enum image_kind kind,
                                struct byte_ranges *parts);

#ifdef __cplusplus
}
#endif

#endif
