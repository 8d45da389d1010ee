/* What the first bytes of image files say: their kind, and what of BMP and PGM files OpenImageIO
 * would not hand on as it is stored. */
#ifndef SONJECT_SWATH_IMAGE_HEAD_H
#define SONJECT_SWATH_IMAGE_HEAD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

#ifdef __cplusplus
extern "C" {
#endif

enum image_kind {
    IMAGE_TIFF,
    IMAGE_PNG,
    IMAGE_JPEG,
    IMAGE_BMP,
    IMAGE_PGM,
    IMAGE_KINDS
};

#define PNG_PALETTE_BYTES 768 /* red, green and blue of 256 numbers */

/* The message for a file of no kind that sonject reads, by its first bytes. Returns INPUT. */
sonject_status image_kind_refuse(struct report *report, const char *path, const unsigned char *head,
                                 size_t count);

/* Told by bytes from a file's beginning; false for another kind. */
bool image_kind_of_beginning(const unsigned char *bytes, size_t count, enum image_kind *kind);

/* BMP and PGM have no checksums, and OpenImageIO takes what their heads say: refuses (INPUT)
 * files whose length is not what the head says, and numbers that OpenImageIO would not hand on as
 * they are stored: those of a PGM that is not of 8 bits are scaled there, so that half of a 16-bit
 * one's come out by one too small. name: of the file in messages. */
sonject_status bmp_check(struct report *report, const char *name, const char *path);
sonject_status pgm_check(struct report *report, const char *name, const char *path);

#ifdef __cplusplus
}
#endif

#endif
