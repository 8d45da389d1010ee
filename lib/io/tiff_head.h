/* The beginning of a TIFF file that is to be written. */
#ifndef SONJECT_IO_TIFF_HEAD_H
#define SONJECT_IO_TIFF_HEAD_H

#include <stddef.h>

#include "image/raster.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Everything that stands before the pixels of an uncompressed TIFF (or BigTIFF, where 4 GB do not
 * hold it): the rows follow as they are, in this machine's byte order, channels interleaved.
 * description: text for the file, may be "". The same arguments give the same bytes. *count gets
 * their number. Returns NULL when memory is out; else to be given to free(). */
unsigned char *tiff_make_head(const struct raster_layout *layout, const char *description,
                              size_t *count);

#ifdef __cplusplus
}
#endif

#endif
