/* What an image says about itself: its seabed's speckle, and the seam around what was put in. */
#ifndef SONJECT_MEASURE_H
#define SONJECT_MEASURE_H

#include <stdint.h>

#include <sonject/context.h>
#include <sonject/export.h>
#include <sonject/image.h>
#include <sonject/result.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

/* An image file, and what is told of it. All files have the image's size; of masks, any pixel that
 * is not 0 counts. */
typedef struct sonject_measure_params {
    uint32_t struct_size;
    uint32_t has_transfer; /* 1: transfer below is used; 0: plain amplitude */
    const char *image;     /* one channel, or two: real and imaginary part */
    const char *before;    /* the image before the injection; NULL: not told */
    const char *influence; /* mask of what the injection changed; NULL: the pixels in which image
                              and before differ, and those within 2 of them */
    const char *labels;    /* mask of highlights and shadows; NULL: none */
    sonject_transfer_params transfer;
} sonject_measure_params;

/* Plain amplitude, no masks. */
SONJECT_API void sonject_measure_params_init(sonject_measure_params *params);

typedef struct sonject_measurement {
    uint32_t struct_size;
    uint32_t reserved;
    /* Untouched seabed, medians over blocks of 32 x 32 pixels. NaN: nothing can be told. */
    double amplitude_contrast; /* standard deviation over mean; Rayleigh: 0.523 */
    double intensity_contrast; /* Rayleigh: 1 */
    double looks;              /* independent samples averaged in a pixel, >= 1 */
    double shape;              /* of the K distribution of intensity; infinite: no texture */
    double row_correlation;    /* of speckle's intensity, from a row to the next */
    double column_correlation; /* from a column to the next */
    double row_length_pixels;  /* where the intensity's correlation falls to 1/e, at most 7 */
    double column_length_pixels;
    /* The seam: how well a linear classifier on local statistics tells patches of 12 x 12 pixels
     * that the injection changed, but that are not beside highlights and shadows, from
     * untouched ones on both sides: 0.5 chance, 1 always. Cross-validated; NaN: no influence was
     * told, or fewer than 10 patches. */
    double seam;
    double seam_error;  /* standard error */
    double seam_before; /* the same patches of the image before: what the seabed's own unevenness
                           tells; NaN without that image */
    uint64_t seam_patches;
    uint64_t background_patches;
} sonject_measurement;

/* Measures an image file. measurement->struct_size must be set. Errors: ARGUMENT, INPUT, STORAGE,
 * MEMORY, UNSUPPORTED. */
SONJECT_API sonject_status sonject_measure(sonject_context *context,
                                           const sonject_measure_params *params,
                                           sonject_measurement *measurement);

/* The same of pixels in memory, linear. influence, labels: rows x columns bytes, packed, not 0
 * where they count; either may be NULL. Errors: ARGUMENT, INPUT, MEMORY. */
SONJECT_API sonject_status sonject_measure_pixels(sonject_context *context,
                                                  const sonject_pixels *pixels,
                                                  const uint8_t *influence, const uint8_t *labels,
                                                  sonject_measurement *measurement);

SONJECT_END_DECLARATIONS

#endif
