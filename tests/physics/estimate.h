/* Numbers that claims are held to: means with their standard errors, decibels, comparisons. */
#ifndef SONJECT_TESTS_ESTIMATE_H
#define SONJECT_TESTS_ESTIMATE_H

#include "claims.h"

/* A mean and its standard error. */
struct estimate {
    double mean, error;
};

/* From the scatter of values; from their sum and that of their squares. */
struct estimate estimate_of(const double *values, size_t count);
struct estimate estimate_of_sums(double sum, double squares, double count);
struct estimate ratio_of(struct estimate one, struct estimate other);

double decibels_of_amplitude(double ratio);
double decibels_of_energy(double ratio);
double sinc(double x); /* sin(pi x) / (pi x) */

/* Taylor's pattern by its zeros: those of an ideal pattern of equal lobes, stretched to meet the
 * sinc's from number `terms` on. */
double taylor_pattern(double sidelobe_db, int terms, double z);

/* Where a unimodal function of a number is least, by ternary search. */
double least_at(double (*function)(double at, const void *context), const void *context, double low,
                double high);

/* Index, as a fraction, at which a line of visibilities (0...1) passes 1/2 between first and last.
 * The edge of a shadow is a step smoothed by G^2, hence an error function, which is what is
 * interpolated. NaN if there is no such place. */
double shadow_edge(const double *visibilities, size_t first, size_t last);

/* A sequence of uniform numbers, its state the caller's. */
double next_uniform(uint64_t *state);

/* Prints and compares: |measured - expected| <= tolerance; measured < limit. */
void expect_close(const char *what, double measured, double expected, double tolerance);
void expect_below(const char *what, double measured, double limit);

/* Within four standard errors and what is systematic. */
void expect_estimate(const char *what, struct estimate measured, double expected,
                     double systematic);

#endif
