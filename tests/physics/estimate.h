/* Numbers of the claims: means with their standard errors, decibels, comparisons. */
#ifndef SONJECT_TESTS_ESTIMATE_H
#define SONJECT_TESTS_ESTIMATE_H

#include "claims.h"

/* A mean and its standard error. */
struct estimate {
    double mean, error;
};

/* Return estimates, from the scatter of values or from the sums of values and squares. */
struct estimate estimate_of(const double *values, size_t count);
struct estimate estimate_of_sums(double sum, double squares, double count);
struct estimate ratio_of(struct estimate one, struct estimate other);

double decibels_of_amplitude(double ratio);
double decibels_of_energy(double ratio);
double sinc(double x); /* sin(pi x) / (pi x) */

/* Returns Taylor's pattern, worked out by its zeros. They are the zeros of an ideal pattern of
 * equal lobes, stretched to meet the sinc's zeros from number `terms` on. */
double taylor_pattern(double sidelobe_db, int terms, double z);

/* Returns the argument at which a unimodal function is least, by ternary search. */
double least_at(double (*function)(double at, const void *context), const void *context, double low,
                double high);

/* Returns the fractional index at which a line of visibilities (0...1) passes 1/2 between first and
 * last. NaN if there is no such place. The edge of a shadow is a step smoothed by G^2, so an error
 * function is interpolated. */
double shadow_edge(const double *visibilities, size_t first, size_t last);

/* Returns the next number of a uniform sequence. The caller owns the state. */
double next_uniform(uint64_t *state);

/* Print and compare: |measured - expected| <= tolerance; measured < limit. */
void expect_close(const char *what, double measured, double expected, double tolerance);
void expect_below(const char *what, double measured, double limit);

/* Compares within four standard errors plus the systematic error. */
void expect_estimate(const char *what, struct estimate measured, double expected,
                     double systematic);

#endif
