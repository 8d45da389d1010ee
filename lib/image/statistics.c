#include "image/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* Half width of a running mean such that three passes have the variance of the deviation asked
 * for: a mean over 2h + 1 pixels has variance ((2h + 1)^2 - 1) / 12. */
static size_t half_width(double deviation, size_t count)
{
    const double width = sqrt(4.0 * deviation * deviation + 1.0);
    const double half = floor(0.5 * (width - 1.0) + 0.5);
    const double limit = (double)count;
    return (size_t)fmin(fmax(half, 0.0), limit);
}

/* Running mean of a line of `count` values, `stride` apart; ends: mean over what is inside. */
static void running_mean(const double *from, double *to, size_t count, size_t half)
{
    double sum = 0.0;
    size_t inside = 0;
    for (size_t i = 0; i < count && i < half; i++, inside++)
        sum += from[i];
    for (size_t i = 0; i < count; i++) {
        if (i + half < count) {
            sum += from[i + half];
            inside++;
        }
        if (i > half) {
            sum -= from[i - half - 1];
            inside--;
        }
        to[i] = sum / (double)inside;
    }
}

static void smooth_line(float *values, size_t count, size_t stride, size_t half, double *a,
                        double *b)
{
    for (size_t i = 0; i < count; i++)
        a[i] = values[i * stride];
    running_mean(a, b, count, half);
    running_mean(b, a, count, half);
    running_mean(a, b, count, half);
    for (size_t i = 0; i < count; i++)
        values[i * stride] = (float)fmax(0.0, b[i]);
}

sonject_status local_mean(struct report *report, const float *values, size_t rows, size_t columns,
                          double row_deviation, double column_deviation, float *mean)
{
    const size_t longest = rows > columns ? rows : columns;
    double *a = allocate_array(longest, sizeof *a);
    double *b = allocate_array(longest, sizeof *b);
    if (!a || !b) {
        free(a);
        free(b);
        return report_out_of_memory(report, "the local mean");
    }
    memcpy(mean, values, rows * columns * sizeof *mean);
    const size_t column_half = half_width(column_deviation, columns);
    const size_t row_half = half_width(row_deviation, rows);
    for (size_t row = 0; column_half > 0 && row < rows; row++)
        smooth_line(mean + row * columns, columns, 1, column_half, a, b);
    for (size_t column = 0; row_half > 0 && column < columns; column++)
        smooth_line(mean + column, rows, columns, row_half, a, b);
    free(a);
    free(b);
    return SONJECT_OK;
}

void mean_and_deviation(const float *values, size_t count, double *mean, double *deviation)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += values[i];
    *mean = sum / (double)count;
    double squares = 0.0;
    for (size_t i = 0; i < count; i++)
        squares += (values[i] - *mean) * (values[i] - *mean);
    *deviation = sqrt(squares / (double)count);
}

#define NOISE_BLOCK   7
#define NOISE_LOWEST  0.001 /* -30 dB */
#define NOISE_HIGHEST 0.01  /* -20 dB */

/* Shadows show the noise floor: the darkest block of a patch that has some. Measured shadows lie
 * 15 to 30 dB under the seabed around them, filled by noise and by what the aperture sees past the
 * object; a patch without a shadow only has a darkest piece of seabed, which says nothing, so the
 * answer is held between -30 and -20 dB. */
sonject_status estimate_noise_floor(struct report *report, const float *intensity,
                                    const float *level, size_t rows, size_t columns, double *ratio)
{
    (void)report;
    double darkest = NOISE_HIGHEST;
    for (size_t row = 0; row + NOISE_BLOCK <= rows; row += NOISE_BLOCK)
        for (size_t column = 0; column + NOISE_BLOCK <= columns; column += NOISE_BLOCK) {
            double sum = 0.0;
            for (size_t r = row; r < row + NOISE_BLOCK; r++)
                for (size_t c = column; c < column + NOISE_BLOCK; c++)
                    sum += (double)intensity[r * columns + c] / level[r * columns + c];
            darkest = fmin(darkest, sum / (NOISE_BLOCK * NOISE_BLOCK));
        }
    *ratio = fmax(darkest, NOISE_LOWEST);
    return SONJECT_OK;
}

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a;
    const float y = *(const float *)b;
    return (x > y) - (x < y);
}

/* A sorted copy of the sample over its mean. */
static float *sorted_over_mean(const float *values, size_t count)
{
    float *sorted = allocate_array(count, sizeof *sorted);
    if (!sorted)
        return NULL;
    double mean, deviation;
    mean_and_deviation(values, count, &mean, &deviation);
    for (size_t i = 0; i < count; i++)
        sorted[i] = (float)(mean > 0.0 ? values[i] / mean : values[i]);
    qsort(sorted, count, sizeof *sorted, by_value);
    return sorted;
}

sonject_status histogram_distance(struct report *report, const float *a, const float *b,
                                  size_t count, double *distance)
{
    float *x = sorted_over_mean(a, count);
    float *y = sorted_over_mean(b, count);
    *distance = 0.0;
    size_t i = 0;
    size_t j = 0;
    while (x && y && i < count && j < count) {
        const float value = x[i] < y[j] ? x[i] : y[j];
        while (i < count && x[i] <= value)
            i++;
        while (j < count && y[j] <= value)
            j++;
        *distance = fmax(*distance, fabs((double)i - (double)j) / (double)count);
    }
    const bool failed = !x || !y;
    free(x);
    free(y);
    return failed ? report_out_of_memory(report, "the histogram distance") : SONJECT_OK;
}

double correlation(const float *a, const float *b, size_t count)
{
    double mean_a, mean_b, deviation_a, deviation_b;
    mean_and_deviation(a, count, &mean_a, &deviation_a);
    mean_and_deviation(b, count, &mean_b, &deviation_b);
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += (a[i] - mean_a) * (b[i] - mean_b);
    return deviation_a > 0.0 && deviation_b > 0.0
               ? sum / ((double)count * deviation_a * deviation_b)
               : 0.0;
}
