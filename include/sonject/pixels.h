/* Pixels in the caller's memory, and transfer functions from amplitudes to stored numbers. */
#ifndef SONJECT_PIXELS_H
#define SONJECT_PIXELS_H

#include <stddef.h>
#include <stdint.h>

#include <sonject/context.h>
#include <sonject/export.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

/* The numbers of a pixel. */
typedef enum sonject_pixel_kind {
    SONJECT_PIXELS_AMPLITUDE = 0, /* float, 0 to 1e15, rms above 1e-15; any number with a transfer
                                     function */
    SONJECT_PIXELS_COMPLEX = 1,   /* pairs of float, real and imaginary part, without a transfer
                                     function; a path of travel time t has the phase +2 pi f t */
    SONJECT_PIXELS_UINT8 = 2,     /* uint8_t, with a transfer function */
    SONJECT_PIXELS_UINT16 = 3     /* uint16_t, with a transfer function */
} sonject_pixel_kind;

/* Pixels in the caller's memory; they are never kept and never written. */
typedef struct sonject_pixels {
    uint32_t struct_size;
    uint32_t kind; /* sonject_pixel_kind */
    uint64_t rows;
    uint64_t columns;
    uint64_t row_stride; /* bytes from a row to the next, a multiple of a number's size; 0: rows are
                            packed */
    const void *data;    /* aligned as its numbers are */
    const char *transfer; /* function that made the numbers from amplitudes, in the words of a
                             scene's input.transfer: "{kind: decibel, parameter: 0.5}"; NULL: the
                             pixels are linear */
} sonject_pixels;

/* Converts pixels to another kind and transfer function (NULL: linear amplitudes). buffer gets
 * packed rows; it has exactly rows * columns * pixel size bytes, aligned as its values are.
 * AMPLITUDE and NULL give the amplitudes of stored numbers. UINT8 and "{kind: gamma, parameter: 2}"
 * give the grey levels of amplitudes. Whole numbers are rounded and limited to full scale, as a run
 * stores them; a line of the log tells how many were limited. Errors: ARGUMENT (also complex
 * pixels, wrong size), INPUT (pixels that are not finite, negative or without an amplitude: the
 * message names the first; an impossible transfer function), MEMORY. */
SONJECT_API sonject_status sonject_pixels_convert(sonject_context *context,
                                                  const sonject_pixels *pixels,
                                                  sonject_pixel_kind kind, const char *transfer,
                                                  void *buffer, size_t bytes);

SONJECT_END_DECLARATIONS

#endif
