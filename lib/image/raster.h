/* Rasters: the stored pixels of an image or a region, as they lie in the file. Also transfer
 * functions, from stored numbers to amplitudes and back. */
#ifndef SONJECT_IMAGE_RASTER_H
#define SONJECT_IMAGE_RASTER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/params.h"

#include "base/report.h"

enum pixel_type {
    PIXEL_UINT8,
    PIXEL_UINT16,
    PIXEL_FLOAT32
};

size_t pixel_bytes(enum pixel_type type);

/* Returns the number that stores amplitude 1 under the plain transfer: 255, 65535 or 1. */
double pixel_full_scale(enum pixel_type type);

/* Returns number i of an array of a type. */
double pixel_number(enum pixel_type type, const void *pixels, size_t i);

/* Stores a number, rounded for integer types. Returns false if the type cannot hold the number. */
bool pixel_store(enum pixel_type type, void *pixels, size_t i, double number);

struct raster_layout {
    uint64_t rows, columns;
    uint32_t channels;
    enum pixel_type type;
};

bool layouts_are_alike(const struct raster_layout *one, const struct raster_layout *other);

/* Returns the rows in memory while an image is written piece by piece: about 64 MB at most. */
uint64_t rows_at_once(const struct raster_layout *layout);

struct region {
    uint64_t first_row, first_column, rows, columns;
};

/* Returns the number of a pixel of one channel, or the magnitude of a complex pixel of two. */
double pixel_magnitude(const struct raster_layout *layout, const void *pixels, size_t i);

/* Finds the bytes of a region's pixels. Returns false if they overflow size_t. */
bool region_bytes(const struct raster_layout *layout, const struct region *region, size_t *bytes);

/* Returns whether a region is not empty and lies inside the layout, safe against overflow. */
bool region_is_inside(const struct raster_layout *layout, const struct region *region);

/* Finds the amplitudes of count stored values (one channel). stored and amplitude must not overlap.
 * *clipped is increased by the number of values at full scale (integer types). Errors: INPUT (an
 * amplitude is not finite, or negative but under the plain transfer; *bad gets its index, and the
 * caller reports row and column). */
sonject_status transfer_to_amplitude(const sonject_transfer_params *transfer, enum pixel_type type,
                                     const void *stored, size_t count, float *amplitude,
                                     size_t *bad, uint64_t *clipped);

/* Finds the stored values of count amplitudes >= 0, rounded to multiples of step (1: all whole
 * numbers) and limited to full scale. step 0 stores values as they are. *clipped is increased by
 * the number of values that were limited from above. */
void transfer_to_stored(const sonject_transfer_params *transfer, enum pixel_type type,
                        uint32_t step, const float *amplitude, size_t count, void *stored,
                        uint64_t *clipped);

/* Returns the amplitude from which on a pixel holds its largest number; INFINITY for floats that
 * are not whole numbers. */
double transfer_ceiling(const sonject_transfer_params *transfer, enum pixel_type type,
                        bool is_whole);

/* Returns the step of count stored integers, the largest whole number that divides all of them.
 * Floats have 0. A step that leaves fewer than 16 levels becomes 1. 8 bit pictures kept in 16 bits
 * have 256 or 257. */
uint32_t quantisation_step(enum pixel_type type, const void *stored, size_t count);

#endif
