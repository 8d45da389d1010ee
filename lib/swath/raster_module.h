/* The module of image files: a shared object of its own, which is loaded when the first image needs
 * it, because OpenImageIO brings along some 250 libraries, whose loading takes longer than many a
 * run. The decoder reads by it, the library writes. Static libraries have it in them. */
#ifndef SONJECT_IO_RASTER_MODULE_H
#define SONJECT_IO_RASTER_MODULE_H

#include "swath/raster_image.h"

#define RASTER_MODULE_MARK UINT32_C(0x736e6a31)

/* What the module offers. What stands before the functions keeps its place in all versions: by it a
 * library knows a module that was built with it, for both share the structures of the calls. */
struct raster_module {
    uint32_t mark;         /* RASTER_MODULE_MARK */
    uint32_t module_bytes; /* of this structure, and of others that pass between the two */
    uint32_t report_bytes;
    uint32_t encoding_bytes;
    char version[16]; /* of sonject */
    sonject_status (*open)(struct report *report, const char *name, const char *path,
                           struct raster_image **image, struct raster_layout *layout);
    void (*close)(struct raster_image **image);
    char *(*attribute)(const struct raster_image *image, const char *name);
    sonject_status (*read)(struct report *report, struct raster_image *image,
                           const struct region *region, void *pixels);
    sonject_status (*change)(struct report *report, const struct raster_image *image,
                             const struct region *region, const void *pixels);
    sonject_status (*encode)(struct report *report, const struct raster_encoding *encoding);
};

/* The one thing that the module shows. */
SONJECT_API extern const struct raster_module raster_module_openimageio;

/* The module, which the first call loads; any number of threads may call. It stays until the
 * process ends. path: the image that needs it, for the message. Errors: UNSUPPORTED (there is no
 * module, or one that was not built with this library: says where, and what to do), MEMORY. */
sonject_status raster_module_find(struct report *report, const char *path,
                                  const struct raster_module **module);

#endif
