/* Images that the decoder reads and changes. */
#ifndef SONJECT_SWATH_DECODED_IMAGE_H
#define SONJECT_SWATH_DECODED_IMAGE_H

#include <sonject/context.h>

#include "image/raster.h"
#include "swath/decoder.h"

struct decoded_image {
    struct decoder_file file;
    struct raster_layout layout;
    uint32_t largest; /* that it may hold; 0: its type's */
    bool is_turned;   /* columns lie together in the file */
    char *array;      /* which of the file; NULL: the only one */
};

/* array: as of swath_file_open_array. Errors: as decoder_open, and INPUT for more samples than the
 * file can hold. On success *image is the caller's, for decoded_image_close; on failure NULL. */
sonject_status decoded_image_open(struct report *report, const char *path, const char *array,
                                  struct decoded_image **image);
void decoded_image_close(struct decoded_image **image);

/* A text that is stored with it; false if there is none of that name or it does not fit. name "":
 * the whole description of an image of OpenImageIO's. */
bool decoded_image_attribute(struct decoded_image *image, const char *name, char *value,
                             size_t capacity);

/* Samples of a region, row after row. Errors: INPUT, STORAGE, MEMORY. */
sonject_status decoded_image_read(struct report *report, struct decoded_image *image,
                                  const struct region *region, void *pixels);

#endif
