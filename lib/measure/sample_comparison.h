/* Whether two sets of numbers come from one distribution. */
#ifndef SONJECT_MEASURE_SAMPLE_COMPARISON_H
#define SONJECT_MEASURE_SAMPLE_COMPARISON_H

#include <stddef.h>

struct sample_summary {
    size_t count;
    double mean, error; /* standard error of the mean; NaN where there are too few */
};

struct sample_comparison {
    struct sample_summary first, second;
    double distance;    /* Kolmogorov-Smirnov, 0...1; NaN where a set is empty */
    double probability; /* that two sets of one distribution are at least that far apart:
                           asymptotic, with Stephens's correction for small sets */
};

/* Sorts both. */
struct sample_comparison compare_samples(double *first, size_t first_count, double *second,
                                         size_t second_count);

#endif
