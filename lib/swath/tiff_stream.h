/* libtiff's files by C's streams, for it knows no UTF-8 paths on Windows. */
#ifndef SONJECT_SWATH_TIFF_STREAM_H
#define SONJECT_SWATH_TIFF_STREAM_H

#include <stdint.h>

#include <tiffio.h>

#include "swath/image_library.h"

#define TIFF_BLOCK_BYTES_MAX ((uint64_t)256 << 20) /* of a tile or strip, decoded */

/* As TIFFOpen, of modes r, r+ and w; prints nothing. NULL where that fails: fault tells why. fault
 * stays where it is while the file is open. */
TIFF *tiff_open(const char *path, const char *mode, struct library_fault *fault);

#endif
