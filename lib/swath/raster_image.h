/* Image files by OpenImageIO: what the module of image files is made of. Implemented in C++; no
 * exception leaves it. Reading is for the decoder (swath/decoder.h) alone. */
#ifndef SONJECT_IO_RASTER_IMAGE_H
#define SONJECT_IO_RASTER_IMAGE_H

#include "base/report.h"
#include "image/raster.h"
#include "swath/image_kind.h"

#ifdef __cplusplus
extern "C" {
#endif

struct raster_image;

/* Opens for reading; name: of the file in messages. Refuses (INPUT, with the file's name and what
 * to do): what OpenImageIO cannot read, more than 2^40 pixels, dimensions of 0, pixel types other
 * than 8 and 16 bit unsigned and 16 and 32 bit float, palettes, channel counts other than 1 and 2.
 * layout is set on success. *image is the caller's then, for raster_image_close; on failure NULL.
 */
sonject_status raster_image_open(struct report *report, const char *name, const char *path,
                                 struct raster_image **image, struct raster_layout *layout);
void raster_image_close(struct raster_image **image);

/* A text that is stored with the image, as a line "name=value" of its description: for free(), NULL
 * if there is none of that name. name "": the whole description. */
char *raster_image_attribute(const struct raster_image *image, const char *name);

/* Reads a region's stored pixels, row after row, channels interleaved. Holds no more than the tiles
 * or strips of the region in memory. Errors: INPUT (cut short, damaged), MEMORY. */
sonject_status raster_image_read(struct report *report, struct raster_image *image,
                                 const struct region *region, void *pixels);

/* Replaces a region's pixels in the file itself, which must be a TIFF: tiff_change. */
sonject_status raster_image_change(struct report *report, const struct raster_image *image,
                                   const struct region *region, const void *pixels);

/* A file that is to be written. */
struct raster_encoding {
    const char *path;
    const char *name; /* of the finished file, for messages */
    enum image_kind kind;
    struct raster_layout layout;
    const char *description; /* a text that the file keeps; "": none */
    bool is_drawn;           /* a mask or a picture, not an image of measured pixels */
    /* gives the pixels of rows first...end */
    sonject_status (*give_rows)(void *user, uint64_t first, uint64_t end, void *pixels);
    void *user;
};

/* Streams in strips of at most about 64 MB. What failed is left to the caller to remove. Errors:
 * STORAGE, MEMORY, those of give_rows. */
sonject_status raster_image_encode(struct report *report, const struct raster_encoding *encoding);

#ifdef __cplusplus
}
#endif

#endif
