/* Rasters: stored pixels of an image or of a region of one, as they lie in the file; and transfer
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

/* The value that amplitude 1 is stored as under the plain transfer: 255, 65535 or 1. */
double pixel_full_scale(enum pixel_type type);

/* Number i of many of that type. */
double pixel_number(enum pixel_type type, const void *pixels, size_t i);

/* Stores one, rounded where the type is a whole one. False if the type does not hold it. */
bool pixel_store(enum pixel_type type, void *pixels, size_t i, double number);

struct raster_layout {
    uint64_t rows, columns;
    uint32_t channels;
    enum pixel_type type;
};

bool layouts_are_alike(const struct raster_layout *one, const struct raster_layout *other);

/* Rows that are in memory where an image is written some at a time: of about 64 MB at most. */
uint64_t rows_at_once(const struct raster_layout *layout);

struct region {
    uint64_t first_row, first_column, rows, columns;
};

/* The number of a pixel of one channel, or its magnitude where two make it complex. */
double pixel_magnitude(const struct raster_layout *layout, const void *pixels, size_t i);

/* Bytes of a region's pixels; false if that overflows size_t. */
bool region_bytes(const struct raster_layout *layout, const struct region *region, size_t *bytes);

/* True if region is not empty and lies inside the layout; safe against overflow. */
bool region_is_inside(const struct raster_layout *layout, const struct region *region);

/* Amplitudes of count stored values (one channel). stored and amplitude must not overlap. A NaN or
 * infinite value is refused: *bad gets its index and INPUT is returned (no message: the caller
 * knows row and column). *clipped is increased by the number of values at full scale (integer
 * types) */
sonject_status transfer_to_amplitude(const sonject_transfer_params *transfer, enum pixel_type type,
                                     const void *stored, size_t count, float *amplitude,
                                     size_t *bad, uint64_t *clipped);

/* Stored values of count amplitudes >= 0, rounded to multiples of step (1: all whole numbers)
 * and limited to full scale; as they are where step is 0. *clipped is increased by the number of
 * values that were limited from above. */
void transfer_to_stored(const sonject_transfer_params *transfer, enum pixel_type type,
                        uint32_t step, const float *amplitude, size_t count, void *stored,
                        uint64_t *clipped);

/* Amplitude from which on a pixel holds its largest number; INFINITY for floats that are no whole
 * numbers. */
double transfer_ceiling(const sonject_transfer_params *transfer, enum pixel_type type,
                        bool is_whole);

/* The step of count stored integers: the largest whole number that divides them all; 0 for floats,
 * 1 where that leaves fewer than 16 levels; 8 bit pictures kept in 16 bits have 256 or 257. */
uint32_t quantisation_step(enum pixel_type type, const void *stored, size_t count);

#endif
