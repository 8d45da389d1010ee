/* Libraries of others that read, change and write images, as the decoder (swath/decoder.h) and
 * those that write new images use them: libtiff and libpng, OpenImageIO, and HDF5.
 *
 * Two modules hold those of images: shared objects of their own, each loaded when the first image
 * needs it, because OpenImageIO brings along some 250 libraries, whose loading takes longer than
 * many a run. Static libraries have both in them. */
#ifndef SONJECT_SWATH_IMAGE_LIBRARY_H
#define SONJECT_SWATH_IMAGE_LIBRARY_H

#include "image/raster.h"
#include "swath/image_head.h"

#ifdef __cplusplus
extern "C" {
#endif

#define DESCRIPTION_MAX ((size_t)1 << 16) /* bytes of one that is kept, its final 0 among them */

struct image_facts {
    enum image_kind kind; /* that the file's beginning told; not of HDF5's */
    struct raster_layout layout;
    uint32_t largest; /* that it may hold; 0: its type's */
    bool is_turned;   /* columns lie together in the file */
    /* what is stored with the image: texts, each a line "name=value"; for free(); NULL: none */
    char *description;
};

struct image_library {
    /* path: the file; name: of it in messages; array: NULL for the only one; writes: it is a copy
     * to be changed. On success *image is the caller's, for close. */
    sonject_status (*open)(struct report *report, const char *name, const char *path,
                           const char *array, bool writes, void **image, struct image_facts *facts);
    /* brings what was changed to the file; *image is gone, whatever is returned */
    sonject_status (*close)(struct report *report, void *image);
    /* samples of a region, row after row; a float64 that stays the same as float32 keeps its bits
     */
    sonject_status (*read)(struct report *report, void *image, const struct region *region,
                           void *pixels);
    /* NULL: copies are new images */
    sonject_status (*change)(struct report *report, void *image, const struct region *region,
                             const void *pixels);
};

/* Data sets of HDF5 files (swath/hdf5_array.c). Calls come between hdf5_enter and hdf5_leave. */
extern const struct image_library hdf5_library;

/* TIFF files by libtiff (swath/tiff_file.c). Refused (INPUT) are files that
 * are cut short, and those whose pixels are not stored as sonject can read and change them; pixels
 * are not decoded then. Changed tiles or strips that no longer fit in their place go behind the end
 * of the file; all tags, other pages and untouched blocks stay. */
extern const struct image_library tiff_library;

/* A file that is to be written. */
struct image_encoding {
    const char *path;
    const char *name; /* of the finished file, for messages */
    enum image_kind kind;
    struct raster_layout layout;
    const char *description; /* a text that the file keeps; "": none */
    bool is_drawn;           /* a mask or a picture, not an image of measured pixels */
    const uint8_t *palette;  /* of PNG: PNG_PALETTE_BYTES, colours of 8 bit numbers; NULL: grey */
    /* gives the pixels of rows first...end */
    sonject_status (*give_rows)(void *user, uint64_t first, uint64_t end, void *pixels);
    void *user;
    int quality; /* of JPEG, 1...100; 0: as a whole swath's should be */
};

/* As raster_module's encode, of TIFF. */
sonject_status tiff_encode(struct report *report, const struct image_encoding *encoding);

/* By it a library knows a module that was built with it, for both share the structures of the
 * calls. It keeps its place in all versions. */
struct module_stamp {
    uint32_t mark, bytes[3]; /* of structures */
    char version[16];        /* of sonject */
};
#define MODULE_STAMP                                                                               \
    {                                                                                              \
        UINT32_C(0x736e6a31),                                                                      \
            {sizeof(struct raster_module), sizeof(struct report), sizeof(struct image_encoding)},  \
            VERSION_TEXT                                                                           \
    }

/* What a module offers. */
struct raster_module {
    struct module_stamp stamp;
    /* By kind; NULL: of the other module. TIFF alone is changed; copies of others are new images.
     * Refused is what they cannot read, more than 2^40 pixels, sides of 0, palettes but for those
     * of numbers, more than one channel (TIFF: two), and of others than TIFF what is not of 8 or
     * 16 bits. */
    const struct image_library *libraries[IMAGE_KINDS];
    /* Streams in strips of at most about 64 MB. What failed is left to the caller to remove.
     * Errors: STORAGE, MEMORY, those of give_rows. */
    sonject_status (*encode)(struct report *report, const struct image_encoding *encoding);
};

/* The one thing that each module shows: swath/png_file.c, swath/raster_image.cpp. */
SONJECT_API extern const struct raster_module raster_module_tiff_png;
SONJECT_API extern const struct raster_module raster_module_openimageio;

/* The module for images of a kind, which the first call loads; any number of threads may call. It
 * stays until the process ends. path: the image that needs it, for the message. Errors: UNSUPPORTED
 * (there is no module, or one that was not built with this library: says where, and what to do),
 * MEMORY. */
sonject_status raster_module_find(struct report *report, const char *path, enum image_kind kind,
                                  const struct raster_module **module);

#ifdef __cplusplus
}
#endif

#endif
