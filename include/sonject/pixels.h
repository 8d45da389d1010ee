/* Pixels in the caller's memory, and transfer functions, by which stored numbers tell amplitudes.
 */
#ifndef SONJECT_PIXELS_H
#define SONJECT_PIXELS_H

#include <stddef.h>
#include <stdint.h>

#include <sonject/context.h>
#include <sonject/export.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

/* What a pixel is. */
typedef enum sonject_pixel_kind {
    SONJECT_PIXELS_AMPLITUDE = 0, /* float, 0 to 1e15, in the rms above 1e-15; any number with a
                                     transfer function */
    SONJECT_PIXELS_COMPLEX = 1, /* pairs of float, real and imaginary part; a path of travel time t
                                   has phase +2 pi f t; without a transfer function */
    SONJECT_PIXELS_UINT8 = 2,   /* uint8_t, with a transfer function */
    SONJECT_PIXELS_UINT16 = 3   /* uint16_t, with a transfer function */
} sonject_pixel_kind;

/* Pixels in the caller's memory; never kept, never written. */
typedef struct sonject_pixels {
    uint32_t struct_size;
    uint32_t kind; /* sonject_pixel_kind */
    uint64_t rows;
    uint64_t columns;
    uint64_t row_stride;  /* bytes from a row to the next, a multiple of a number's; 0: rows are
                             packed */
    const void *data;     /* aligned as its numbers are */
    const char *transfer; /* how the numbers came from amplitudes, in the words of a scene's
                             input.transfer: "{kind: decibel, parameter: 0.5}"; NULL: the pixels are
                             linear */
} sonject_pixels;

/* The same pixels as another kind, of another transfer function (NULL: linear amplitudes), into
 * buffer of exactly rows * columns * pixel size bytes, aligned as its values are, rows packed: by
 * AMPLITUDE and NULL the amplitudes of stored numbers, by UINT8 and "{kind: gamma, parameter: 2}"
 * the grey levels of amplitudes. Whole numbers are rounded and limited to full scale, as a run
 * stores them; a line of the log tells how many were limited. Errors: ARGUMENT (also complex
 * pixels, wrong size), INPUT (pixels that are not finite, or negative, or have no amplitude: the
 * message names the first; a transfer function that cannot be), MEMORY. */
SONJECT_API sonject_status sonject_pixels_convert(sonject_context *context,
                                                  const sonject_pixels *pixels,
                                                  sonject_pixel_kind kind, const char *transfer,
                                                  void *buffer, size_t bytes);

SONJECT_END_DECLARATIONS

#endif
