/* Transfer functions: stored numbers to amplitudes and back. */
#ifndef SONJECT_IMAGE_TRANSFER_H
#define SONJECT_IMAGE_TRANSFER_H

#include <sonject/image.h>

#include "base/report.h"
#include "image/raster.h"

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

/* The step of count stored integers: the largest whole number that divides them all; 0 for floats,
 * 1 where that leaves fewer than 16 levels; 8 bit pictures kept in 16 bits have 256 or 257. */
uint32_t quantisation_step(enum pixel_type type, const void *stored, size_t count);

#endif
