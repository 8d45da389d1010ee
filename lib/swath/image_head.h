/* What the first bytes of image files say: their kind. */
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

/* The message for a file of no kind that sonject reads, by its first bytes. Returns INPUT. */
sonject_status image_kind_refuse(struct report *report, const char *path, const unsigned char *head,
                                 size_t count);

/* Told by bytes from a file's beginning; false for another kind. */
bool image_kind_of_beginning(const unsigned char *bytes, size_t count, enum image_kind *kind);

#endif
