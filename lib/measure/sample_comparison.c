/* Whether two sets of numbers come from one distribution. */
#include <math.h>
#include <stdlib.h>

#include "measure/contacts.h"

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

static struct sample_summary summarise(const double *values, size_t count)
{
    struct sample_summary summary = {count, NAN, NAN};
    double sum = 0.0;
    double squares = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += values[i];
    if (count > 0)
        summary.mean = sum / (double)count;
    for (size_t i = 0; i < count; i++)
        squares += (values[i] - summary.mean) * (values[i] - summary.mean);
    if (count > 1)
        summary.error = sqrt(squares / ((double)count - 1.0) / (double)count);
    return summary;
}

static double largest_distance(const double *a, size_t a_count, const double *b, size_t b_count)
{
    size_t in_a = 0;
    size_t in_b = 0;
    double largest = 0.0;
    while (in_a < a_count && in_b < b_count) {
        const double value = fmin(a[in_a], b[in_b]);
        while (in_a < a_count && a[in_a] <= value)
            in_a++;
        while (in_b < b_count && b[in_b] <= value)
            in_b++;
        largest =
            fmax(largest, fabs((double)in_a / (double)a_count - (double)in_b / (double)b_count));
    }
    return largest;
}

/* Kolmogorov's distribution, beyond an argument. */
static double kolmogorov_tail(double argument)
{
    double sum = 0.0;
    double sign = 1.0;
    if (argument < 0.2) /* 1 - 5e-13 there, and the series does not converge */
        return 1.0;
    for (int k = 1; k <= 100; k++) {
        sum += sign * exp(-2.0 * k * k * argument * argument);
        sign = -sign;
    }
    return fmin(1.0, fmax(0.0, 2.0 * sum));
}

struct sample_comparison compare_samples(double *first, size_t first_count, double *second,
                                         size_t second_count)
{
    struct sample_comparison comparison;
    comparison.first = summarise(first, first_count);
    comparison.second = summarise(second, second_count);
    comparison.distance = NAN;
    comparison.probability = NAN;
    if (first_count > 0)
        qsort(first, first_count, sizeof *first, by_size);
    if (second_count > 0)
        qsort(second, second_count, sizeof *second, by_size);
    if (first_count > 0 && second_count > 0) {
        const double n = sqrt((double)first_count * (double)second_count /
                              ((double)first_count + (double)second_count));
        comparison.distance = largest_distance(first, first_count, second, second_count);
        comparison.probability = kolmogorov_tail((n + 0.12 + 0.11 / n) * comparison.distance);
    }
    return comparison;
}
