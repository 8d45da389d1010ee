/* Statistics of image patches, and of their speckle. */
#ifndef SONJECT_IMAGE_STATISTICS_H
#define SONJECT_IMAGE_STATISTICS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

/* Smooth local mean of a rows x columns map: three running means one after the other, which are
 * close to a Gaussian and have exactly its standard deviation (in pixels, per axis; 0 leaves the
 * axis as it is). Near edges it is the mean over what is inside. The time does not depend on the
 * deviation. mean may be values. Errors: MEMORY. */
sonject_status local_mean(struct report *report, const float *values, size_t rows, size_t columns,
                          double row_deviation, double column_deviation, float *mean);

/* Pixels away from which nothing enters a local mean. */
size_t local_mean_reach(double deviation);

/* Mean and standard deviation (root of the mean square difference) in double precision; count > 0.
 */
void mean_and_deviation(const float *values, size_t count, double *mean, double *deviation);

/* Sorts the values; count > 0. */
double median_of(double *values, size_t count);

/* The 5, 50 and 95 % quantiles of values, which it sorts; count > 0. */
void spread_of(double *values, size_t count, double spread[3]);

/* Largest distance between the cumulative distributions of two samples (Kolmogorov-Smirnov), each
 * first divided by its own mean: 0...1. Errors: MEMORY. */
sonject_status histogram_distance(struct report *report, const float *a, const float *b,
                                  size_t count, double *distance);

/* Pearson correlation of two samples; 0 where one of them is constant. */
double correlation(const float *a, const float *b, size_t count);

/* What a measured magnitude image says about its own speckle: contrast, looks, texture,
 * correlation. Formulas: kernels/MATH.md, "Blending". */

#define SPECKLE_LAGS  8  /* 0...7 pixels */
#define SPECKLE_BLOCK 32 /* pixels on a side */

struct speckle_axis {
    double correlation[SPECKLE_LAGS]; /* of the intensity, texture taken off; 1 at lag 0 */
    double lag_one_error;             /* standard error of correlation[1] */
    double length_pixels;             /* where the intensity's own correlation falls to 1/e, at most
                                         SPECKLE_LAGS - 1 */
};

/* Medians over blocks, each over its own linear trend, so that a stone or a shadow in the region
 * does not count. */
struct speckle_statistics {
    size_t blocks;             /* that were used; 0: the region is too small or has no speckle, and
                                  nothing else is filled in */
    double amplitude_contrast; /* standard deviation over mean; Rayleigh: 0.523 */
    double intensity_contrast; /* likewise; Rayleigh: 1 */
    double looks;              /* >= 1, independent samples averaged in a pixel */
    double looks_error;        /* standard error */
    double shape;              /* of the K distribution of intensity; INFINITY: no texture */
    struct speckle_axis along_track, range;
};

/* Of the region rows x columns of an image of intensities >= 0, whose rows lie stride floats apart.
 * excluded: the same layout, not 0 for pixels that do not count; may be NULL. Errors: MEMORY. */
sonject_status measure_speckle(struct report *report, const float *intensity,
                               const uint8_t *excluded, size_t rows, size_t columns, size_t stride,
                               struct speckle_statistics *statistics);

/* The amplitude at which an image is cut off: its largest one, if that piles up there; else
 * INFINITY. amplitudes: count values >= 0. */
double find_saturation(const float *amplitudes, size_t count);

#endif
