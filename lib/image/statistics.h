/* Statistics of image patches. */
#ifndef SONJECT_IMAGE_STATISTICS_H
#define SONJECT_IMAGE_STATISTICS_H

#include <stddef.h>

#include "base/report.h"

/* Smooth local mean of a rows x columns map: three passes of a running mean (edge pixels: mean over
 * what is inside), which is close to a Gaussian of the given standard deviation in pixels per axis.
 * values and mean must not overlap. Errors: MEMORY. */
sonject_status local_mean(struct report *report, const float *values, size_t rows, size_t columns,
                          double row_deviation, double column_deviation, float *mean);

/* Mean and standard deviation in double precision; count > 0. */
void mean_and_deviation(const float *values, size_t count, double *mean, double *deviation);

/* Noise floor over the local mean, as an energy ratio, from the darkest places of the patch: see
 * statistics.c for how. intensity and level: rows x columns, level > 0. Errors: MEMORY. */
sonject_status estimate_noise_floor(struct report *report, const float *intensity,
                                    const float *level, size_t rows, size_t columns, double *ratio);

/* Largest distance between the cumulative distributions of two samples (Kolmogorov-Smirnov), each
 * first divided by its own mean. Errors: MEMORY. */
sonject_status histogram_distance(struct report *report, const float *a, const float *b,
                                  size_t count, double *distance);

/* Pearson correlation of two samples. */
double correlation(const float *a, const float *b, size_t count);

#endif
