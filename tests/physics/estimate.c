#include "estimate.h"

#include <math.h>

struct estimate estimate_of_sums(double sum, double squares, double count)
{
    const double mean = sum / count;
    const double variance = squares / count - mean * mean;
    const struct estimate estimate = {mean, sqrt(fmax(0.0, variance) / (count - 1.0))};
    return estimate;
}

struct estimate estimate_of(const double *values, size_t count)
{
    double sum = 0.0, squares = 0.0;
    for (size_t i = 0; i < count; i++) {
        sum += values[i];
        squares += values[i] * values[i];
    }
    return estimate_of_sums(sum, squares, (double)count);
}

struct estimate ratio_of(struct estimate one, struct estimate other)
{
    struct estimate ratio = {one.mean / other.mean, 0.0};
    ratio.error = ratio.mean * hypot(one.error / one.mean, other.error / other.mean);
    return ratio;
}

double decibels_of_amplitude(double ratio)
{
    return 20.0 * log10(ratio);
}

double decibels_of_energy(double ratio)
{
    return 10.0 * log10(ratio);
}

double sinc(double x)
{
    return x == 0.0 ? 1.0 : sin(PI * x) / (PI * x);
}

double taylor_pattern(double sidelobe_db, int terms, double z)
{
    const double a = acosh(pow(10.0, sidelobe_db / 20.0)) / PI;
    const double stretch = terms / sqrt(a * a + (terms - 0.5) * (terms - 0.5));
    double pattern = sinc(z);
    for (int n = 1; n < terms; n++) {
        const double zero = stretch * sqrt(a * a + (n - 0.5) * (n - 0.5));
        pattern *= (1.0 - z * z / (zero * zero)) / (1.0 - z * z / ((double)n * n));
    }
    return pattern;
}

double least_at(double (*function)(double at, const void *context), const void *context, double low,
                double high)
{
    for (int i = 0; i < 100; i++) {
        const double third = (high - low) / 3.0;
        if (function(low + third, context) < function(high - third, context))
            high -= third;
        else
            low += third;
    }
    return 0.5 * (low + high);
}

/* Returns the argument at which a normal distribution reaches a probability, by bisection. */
static double normal_argument(double probability)
{
    double low = -6.0, high = 6.0;
    for (int i = 0; i < 50; i++) {
        const double middle = 0.5 * (low + high);
        *(0.5 * erfc(-middle / sqrt(2.0)) < probability ? &low : &high) = middle;
    }
    return low;
}

double shadow_edge(const double *visibilities, size_t first, size_t last)
{
    for (size_t i = first; i < last; i++)
        if ((visibilities[i + 1] > 0.5) != (visibilities[first] > 0.5)) {
            const double a = normal_argument(visibilities[i]);
            const double b = normal_argument(visibilities[i + 1]);
            return (double)i - a / (b - a);
        }
    return NAN;
}

double next_uniform(uint64_t *state)
{
    *state += UINT64_C(0x9e3779b97f4a7c15);
    uint64_t bits = *state;
    bits = (bits ^ (bits >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    bits = (bits ^ (bits >> 27)) * UINT64_C(0x94d049bb133111eb);
    bits ^= bits >> 31;
    return ((double)(bits >> 11) + 0.5) / 9007199254740992.0;
}

void expect_estimate(const char *what, struct estimate measured, double expected, double systematic)
{
    expect_close(what, measured.mean, expected, 4.0 * measured.error + systematic);
}
