/* The kind of an image file, told by the first bytes. */
#ifndef SONJECT_SWATH_IMAGE_HEAD_H
#define SONJECT_SWATH_IMAGE_HEAD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

enum image_kind {
    IMAGE_TIFF,
    IMAGE_PNG,
    IMAGE_JPEG,
    IMAGE_KINDS
};

#define PNG_PALETTE_BYTES 768 /* red, green and blue of 256 numbers */

/* Refuses a file of a kind that sonject does not read, told by the first bytes. Returns INPUT. */
sonject_status image_kind_refuse(struct report *report, const char *path, const unsigned char *head,
                                 size_t count);

/* Tells the kind by a file's first bytes. Returns false for other kinds. */
bool image_kind_of_beginning(const unsigned char *bytes, size_t count, enum image_kind *kind);

/* Refuses an image whose tag says that viewers show it turned or mirrored: masks and labels would
 * not lie on what they show. orientation: TIFF's number; 1 stands for upright. */
sonject_status image_check_upright(struct report *report, const char *path, uint64_t orientation);

/* Does so by the tag in EXIF data, which are a small TIFF. Damaged ones say nothing. */
sonject_status image_check_exif(struct report *report, const char *path, const unsigned char *tiff,
                                size_t count);

#endif
