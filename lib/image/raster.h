/* Rasters: stored pixels of an image or of a region of one, as they lie in the file. */
#ifndef SONJECT_IMAGE_RASTER_H
#define SONJECT_IMAGE_RASTER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum pixel_type {
    PIXEL_UINT8,
    PIXEL_UINT16,
    PIXEL_FLOAT32
};

size_t pixel_bytes(enum pixel_type type);

/* The value that amplitude 1 is stored as under the plain transfer: 255, 65535 or 1. */
double pixel_full_scale(enum pixel_type type);

struct raster_layout {
    uint64_t rows, columns;
    uint32_t channels;
    enum pixel_type type;
};

struct region {
    uint64_t first_row, first_column, rows, columns;
};

/* Bytes of a region's pixels; false if that overflows size_t. */
bool region_bytes(const struct raster_layout *layout, const struct region *region, size_t *bytes);

/* True if region is not empty and lies inside the layout; safe against overflow. */
bool region_is_inside(const struct raster_layout *layout, const struct region *region);

#ifdef __cplusplus
}
#endif

#endif
