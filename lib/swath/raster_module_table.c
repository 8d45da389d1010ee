#include <sonject/version.h>

#include "swath/raster_module.h"

#define TEXT_OF(number)   #number
#define DIGITS_OF(number) TEXT_OF(number)

const struct raster_module raster_module_openimageio = {
    RASTER_MODULE_MARK,
    sizeof(struct raster_module),
    sizeof(struct report),
    sizeof(struct raster_encoding),
    DIGITS_OF(SONJECT_VERSION_MAJOR) "." DIGITS_OF(SONJECT_VERSION_MINOR) "." DIGITS_OF(
        SONJECT_VERSION_PATCH),
    raster_image_open,
    raster_image_close,
    raster_image_attribute,
    raster_image_read,
    raster_image_change,
    raster_image_encode,
};
