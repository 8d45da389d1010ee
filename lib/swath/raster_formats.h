/* New files of whole rasters, in formats that lose nothing. */
#ifndef SONJECT_SWATH_RASTER_FORMATS_H
#define SONJECT_SWATH_RASTER_FORMATS_H

#include "swath/raster_file.h"

/* True if files of that extension keep attributes. */
bool raster_format_keeps_attributes(const char *path);

/* Checks that the extension of path tells a format that holds such samples. Errors: INPUT (lists
 * the formats). */
sonject_status raster_format_check(struct report *report, const char *path,
                                   const struct raster_layout *layout);

/* Writes the raster: complex where it has 2 channels. Published whole or not at all. Errors: INPUT
 * (as raster_format_check), STORAGE, MEMORY, UNSUPPORTED. */
sonject_status raster_format_write(struct report *report, const char *path,
                                   const struct raster_layout *layout,
                                   const struct raster_attribute *attributes,
                                   size_t attribute_count, const void *pixels);

#endif
