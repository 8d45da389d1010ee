/* What a library of others does with images for the decoder (swath/decoder.h): OpenImageIO, which
 * is in the module of image files, and HDF5. */
#ifndef SONJECT_SWATH_IMAGE_LIBRARY_H
#define SONJECT_SWATH_IMAGE_LIBRARY_H

#include "base/report.h"
#include "image/raster.h"

#ifdef __cplusplus
extern "C" {
#endif

struct image_facts {
    struct raster_layout layout;
    uint32_t largest; /* that it may hold; 0: its type's */
    bool is_turned;   /* columns lie together in the file */
};

struct image_library {
    /* path: the file; name: of it in messages; array: NULL for the only one; writes: it is a copy
     * to be changed. On success *image is the caller's, for close. */
    sonject_status (*open)(struct report *report, const char *name, const char *path,
                           const char *array, bool writes, void **image, struct image_facts *facts);
    /* what was changed and not finished may be lost */
    void (*close)(void *image);
    /* a text that is stored with the image, for free(); NULL if there is none of that name */
    char *(*attribute)(void *image, const char *name);
    /* samples of a region, row after row; a float64 that stays the same as float32 keeps its bits
     */
    sonject_status (*read)(struct report *report, void *image, const struct region *region,
                           void *pixels);
    sonject_status (*change)(struct report *report, void *image, const struct region *region,
                             const void *pixels);
    /* brings all changes to the file */
    sonject_status (*finish)(struct report *report, void *image);
};

#ifdef __cplusplus
}
#endif

#endif
