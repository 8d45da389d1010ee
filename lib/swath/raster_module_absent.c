/* Stands in for the module of image files in builds without OpenImageIO. */
#include "swath/raster_module.h"

#include <stddef.h>

sonject_status raster_module_find(struct report *report, const char *path,
                                  const struct raster_module **module)
{
    *module = NULL;
    return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                          "%s: this build of sonject has no image files: build it with OpenImageIO",
                          path);
}
