/* The module of image files: a shared object of its own, which is loaded when the first image needs
 * it, because OpenImageIO brings along some 250 libraries, whose loading takes longer than many a
 * run. The decoder reads by it, the library writes. Static libraries have it in them. */
#ifndef SONJECT_SWATH_RASTER_MODULE_H
#define SONJECT_SWATH_RASTER_MODULE_H

#include "swath/image_kind.h"
#include "swath/image_library.h"

#ifdef __cplusplus
extern "C" {
#endif

#define RASTER_MODULE_MARK UINT32_C(0x736e6a31)

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

/* What the module offers. What stands before the functions keeps its place in all versions: by it a
 * library knows a module that was built with it, for both share the structures of the calls. */
struct raster_module {
    uint32_t mark;         /* RASTER_MODULE_MARK */
    uint32_t module_bytes; /* of this structure, and of others that pass between the two */
    uint32_t report_bytes;
    uint32_t encoding_bytes;
    char version[16]; /* of sonject */
    /* Refuses what OpenImageIO cannot read, more than 2^40 pixels, dimensions of 0, pixel types
     * other than 8 and 16 bit unsigned and 16 and 32 bit float, palettes, other than 1 or 2
     * channels. Attributes are lines "name=value" of the description, "" is all of it. Holds no
     * more than a region's tiles or strips in memory. TIFF alone is changed. */
    struct image_library library;
    /* Streams in strips of at most about 64 MB. What failed is left to the caller to remove.
     * Errors: STORAGE, MEMORY, those of give_rows. */
    sonject_status (*encode)(struct report *report, const struct raster_encoding *encoding);
};

/* The one thing that the module shows. */
SONJECT_API extern const struct raster_module raster_module_openimageio;

/* The module, which the first call loads; any number of threads may call. It stays until the
 * process ends. path: the image that needs it, for the message. Errors: UNSUPPORTED (there is no
 * module, or one that was not built with this library: says where, and what to do), MEMORY. */
sonject_status raster_module_find(struct report *report, const char *path,
                                  const struct raster_module **module);

#ifdef __cplusplus
}
#endif

#endif
