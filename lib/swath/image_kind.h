/* Which kind of image a file is. */
#ifndef SONJECT_SWATH_IMAGE_KIND_H
#define SONJECT_SWATH_IMAGE_KIND_H

#include <stdbool.h>
#include <stddef.h>

#include "base/report.h"

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

/* The message for a file of no kind that sonject reads, by its first bytes. Returns INPUT. */
sonject_status image_kind_refuse(struct report *report, const char *path, const unsigned char *head,
                                 size_t count);

/* Told by bytes from a file's beginning; false for another kind. */
bool image_kind_of_beginning(const unsigned char *bytes, size_t count, enum image_kind *kind);

/* Told by the extension of a file that is to be written; false for another kind. */
bool image_kind_of_name(const char *path, enum image_kind *kind);

#ifdef __cplusplus
}
#endif

#endif
