/* Statistics of image patches. */
#ifndef SONJECT_IMAGE_STATISTICS_H
#define SONJECT_IMAGE_STATISTICS_H

#include <stddef.h>

#include "base/report.h"

/* Smooth local mean of a rows x columns map: three running means one after the other, which are
 * close to a Gaussian and have exactly its standard deviation (in pixels, per axis; 0 leaves the
 * axis as it is). Near edges it is the mean over what is inside. The time does not depend on the
 * deviation. values and mean must not overlap. Errors: MEMORY. */
sonject_status local_mean(struct report *report, const float *values, size_t rows, size_t columns,
                          double row_deviation, double column_deviation, float *mean);

/* Mean and standard deviation (root of the mean square difference) in double precision; count > 0.
 */
void mean_and_deviation(const float *values, size_t count, double *mean, double *deviation);

/* Noise floor over the local mean, as an energy ratio, from the darkest block of about 7 x 7 pixels
 * of the patch; at least 0.001 (-30 dB). Where it is above 0.01 (-20 dB) there is no shadow in the
 * patch and the darkest block is merely seabed: then 0.0056 (-22.5 dB). intensity and level: rows x
 * columns, level > 0. Errors: MEMORY.
 */
sonject_status estimate_noise_floor(struct report *report, const float *intensity,
                                    const float *level, size_t rows, size_t columns, double *ratio);

/* Largest distance between the cumulative distributions of two samples (Kolmogorov-Smirnov), each
 * first divided by its own mean: 0...1. Errors: MEMORY. */
sonject_status histogram_distance(struct report *report, const float *a, const float *b,
                                  size_t count, double *distance);

/* Pearson correlation of two samples; 0 where one of them is constant. */
double correlation(const float *a, const float *b, size_t count);

#endif
