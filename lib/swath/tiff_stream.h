/* libtiff through C's streams, because libtiff takes no UTF-8 paths on Windows. */
#ifndef SONJECT_SWATH_TIFF_STREAM_H
#define SONJECT_SWATH_TIFF_STREAM_H

#include <stdint.h>

#include <tiffio.h>

#include "swath/image_library.h"

#define TIFF_BLOCK_BYTES_MAX ((uint64_t)256 << 20) /* limit of a decoded tile or strip */

/* Opens a file as TIFFOpen does in the modes r, r+ and w, but prints nothing. Returns NULL on
 * failure; fault tells why. fault must stay in place while the file is open. */
TIFF *tiff_open(const char *path, const char *mode, struct library_fault *fault);

#endif
