/* Where the module of image files is part of the program: static libraries, and tests that let its
 * calls fail. */
#include "swath/raster_module.h"

sonject_status raster_module_find(struct report *report, const char *path,
                                  const struct raster_module **module)
{
    (void)report;
    (void)path;
    *module = &raster_module_openimageio;
    return SONJECT_OK;
}
