/* Statistics of image patches, and of their speckle. */
#ifndef SONJECT_IMAGE_STATISTICS_H
#define SONJECT_IMAGE_STATISTICS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

static inline size_t smaller_size(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Finds a smooth local mean of a rows x columns map by three successive running means. They are
 * close to a Gaussian and have exactly its standard deviation (in pixels, per axis; 0 leaves the
 * axis as it is). Near edges the mean is over the pixels inside. The time does not depend on the
 * deviation. mean may be values. Errors: MEMORY. */
sonject_status local_mean(struct report *report, const float *values, size_t rows, size_t columns,
                          double row_deviation, double column_deviation, float *mean);

/* Returns the distance in pixels from which on nothing enters a local mean. */
size_t local_mean_reach(double deviation);

/* Finds mean and standard deviation (root of the mean squared difference) in doubles. count > 0. */
void mean_and_deviation(const float *values, size_t count, double *mean, double *deviation);

/* Returns the median, and sorts the values. count > 0. */
double median_of(double *values, size_t count);

/* Finds the 5, 50 and 95 % quantiles of values, and sorts them. count > 0. */
void spread_of(double *values, size_t count, double spread[3]);

/* Finds the largest distance between the cumulative distributions of two samples
 * (Kolmogorov-Smirnov), each divided by its own mean: 0...1. Errors: MEMORY. */
sonject_status histogram_distance(struct report *report, const float *a, const float *b,
                                  size_t count, double *distance);

/* Returns the Pearson correlation of two samples; 0 where one of them is constant. */
double correlation(const float *a, const float *b, size_t count);

/* The speckle of a measured magnitude image: contrast, looks, texture, correlation. Formulas:
 * kernels/MATH.md, "Blending". */

#define SPECKLE_LAGS  8  /* lags of 0...7 pixels */
#define SPECKLE_BLOCK 32 /* pixels on a side */

struct speckle_axis {
    double correlation[SPECKLE_LAGS]; /* correlation of the intensity without texture; 1 at lag 0 */
    double lag_one_error;             /* standard error of correlation[1] */
    double length_pixels; /* lag at which the intensity's own correlation falls to 1/e, at most
                             SPECKLE_LAGS - 1 */
};

/* Medians over blocks, each block divided by its own linear trend, so that stones and shadows in
 * the region do not count. */
struct speckle_statistics {
    size_t blocks; /* number of blocks used; 0: the region is too small or has no speckle, and
                      nothing else is filled in */
    double amplitude_contrast; /* standard deviation over mean; Rayleigh: 0.523 */
    double intensity_contrast; /* standard deviation over mean; Rayleigh: 1 */
    double looks;              /* independent samples averaged in a pixel, >= 1 */
    double looks_error;        /* standard error */
    double shape;              /* shape of the intensity's K distribution; INFINITY: no texture */
    struct speckle_axis along_track, range;
};

/* Measures a region of rows x columns of an image of intensities >= 0, whose rows lie stride floats
 * apart. excluded: same layout, not 0 where pixels do not count; may be NULL. Errors: MEMORY. */
sonject_status measure_speckle(struct report *report, const float *intensity,
                               const uint8_t *excluded, size_t rows, size_t columns, size_t stride,
                               struct speckle_statistics *statistics);

/* Returns the amplitude at which an image is cut off, that is, the largest one if many pixels have
 * it, or else INFINITY. amplitudes: count values >= 0. */
double find_saturation(const float *amplitudes, size_t count);

#endif
