#include "image/statistics.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define PASSES        3
#define LINES_AT_ONCE 16 /* floats of a cache line */

#define SIGN_BIT  UINT32_C(0x80000000)
#define SORT_BITS 11 /* bits sorted at a time; three times cover all 32 */
#define SORT_BINS ((size_t)1 << SORT_BITS)

/* A running mean along several lines at once. The weight is 1 up to radius and edge_weight (0...1)
 * one pixel further on either side, so that any variance can be had, not only that of whole
 * widths. */
typedef double line_values[LINES_AT_ONCE];

struct line_mean {
    size_t length, radius;
    double edge_weight;
    double *weight;      /* sum of the weights about each value */
    line_values *line;   /* the values with radius + 1 zeros on either side */
    line_values *before; /* sums from the start of a block of 2 * radius + 1 */
    line_values *after;  /* sums to the end of a block, but 0 at its start */
};

static size_t padded_length(const struct line_mean *mean)
{
    return mean->length + 2 * mean->radius;
}

static double variance_of_pass(double deviation)
{
    return deviation > 0.0 ? deviation * deviation / PASSES : 0.0;
}

static double radius_of_pass(double deviation)
{
    return floor((sqrt(1.0 + 12.0 * variance_of_pass(deviation)) - 1.0) / 2.0);
}

size_t local_mean_reach(double deviation)
{
    return (size_t)fmin(PASSES * (radius_of_pass(deviation) + 1.0), 1e9);
}

static sonject_status line_mean_init(struct line_mean *mean, struct report *report, size_t length,
                                     double deviation)
{
    const double variance = variance_of_pass(deviation);
    const double radius = radius_of_pass(deviation);
    memset(mean, 0, sizeof *mean);
    mean->length = length;
    if (radius < (double)length) {
        mean->radius = (size_t)radius;
        mean->edge_weight = (2.0 * radius + 1.0) * (variance - radius * (radius + 1.0) / 3.0) /
                            (2.0 * ((radius + 1.0) * (radius + 1.0) - variance));
    } else {
        mean->radius = length; /* every mean is that of the whole line */
    }
    mean->weight = allocate_array(length, sizeof *mean->weight);
    mean->line = allocate_array(padded_length(mean) + 2, sizeof *mean->line);
    mean->before = allocate_array(padded_length(mean), sizeof *mean->before);
    mean->after = allocate_array(padded_length(mean), sizeof *mean->after);
    CHECK_MEMORY(report, mean->weight && mean->line && mean->before && mean->after, "a local mean");
    for (size_t i = 0; i < length; i++) {
        const size_t left = i, right = length - 1 - i;
        mean->weight[i] =
            (double)(smaller_size(left, mean->radius) + 1 + smaller_size(right, mean->radius));
        mean->weight[i] += left > mean->radius ? mean->edge_weight : 0.0;
        mean->weight[i] += right > mean->radius ? mean->edge_weight : 0.0;
    }
    return SONJECT_OK;
}

/* Sums within blocks of the window's width. Any window is the end of one block and the start of the
 * next. Nothing is subtracted, so a bright echo leaves no rounding error in its neighbours. */
static void sum_blocks(struct line_mean *mean)
{
    line_values *line = mean->line + 1;
    const size_t width = 2 * mean->radius + 1;
    const size_t padded = padded_length(mean);
    for (size_t start = 0; start < padded; start += width) {
        const size_t end = padded - start < width ? padded : start + width;
        line_values sum = {0.0};
        for (size_t i = start; i < end; i++)
            for (int k = 0; k < LINES_AT_ONCE; k++)
                mean->before[i][k] = sum[k] += line[i][k];
        memset(sum, 0, sizeof sum);
        for (size_t i = end - 1; i > start; i--)
            for (int k = 0; k < LINES_AT_ONCE; k++)
                mean->after[i][k] = sum[k] += line[i][k];
        memset(mean->after[start], 0, sizeof sum);
    }
}

/* Smooths mean->line in place. The caller has filled its inner part. */
static void smooth_line(struct line_mean *mean)
{
    const size_t width = 2 * mean->radius + 1;
    for (int pass = 0; pass < PASSES; pass++) {
        sum_blocks(mean);
        for (size_t i = 0; i < mean->length; i++) {
            const double *last = mean->before[i + width - 1];
            const double *left = mean->line[i], *right = mean->line[i + width + 1];
            double *sum = mean->after[i];
            for (int k = 0; k < LINES_AT_ONCE; k++)
                sum[k] = (sum[k] + last[k] + mean->edge_weight * left[k] +
                          mean->edge_weight * right[k]) /
                         mean->weight[i];
        }
        memcpy(mean->line + mean->radius + 1, mean->after, mean->length * sizeof *mean->line);
    }
}

/* Smooths lines of `length` values, several at once, as memory is laid out by rows. Lines lie
 * `apart` values from one another, values of a line `step`. `from` and `to` may be the same. */
static sonject_status smooth_lines(struct report *report, const float *from, float *to,
                                   size_t lines, size_t apart, size_t length, size_t step,
                                   double deviation)
{
    struct line_mean mean;
    const sonject_status status = line_mean_init(&mean, report, length, deviation);
    for (size_t first = 0; status == SONJECT_OK && first < lines; first += LINES_AT_ONCE) {
        const size_t count = smaller_size(LINES_AT_ONCE, lines - first);
        line_values *line = mean.line + mean.radius + 1;
        for (size_t i = 0; i < length; i++)
            for (size_t k = 0; k < count; k++)
                line[i][k] = (double)from[(first + k) * apart + i * step];
        smooth_line(&mean);
        for (size_t i = 0; i < length; i++)
            for (size_t k = 0; k < count; k++)
                to[(first + k) * apart + i * step] = (float)line[i][k];
    }
    free(mean.weight);
    free(mean.line);
    free(mean.before);
    free(mean.after);
    return status;
}

sonject_status local_mean(struct report *report, const float *values, size_t rows, size_t columns,
                          double row_deviation, double column_deviation, float *mean)
{
    if (rows == 0 || columns == 0)
        return SONJECT_OK;
    CHECK(smooth_lines(report, values, mean, rows, columns, columns, 1, column_deviation));
    return smooth_lines(report, mean, mean, columns, 1, rows, columns, row_deviation);
}

static double mean_of(const float *values, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += (double)values[i];
    return sum / (double)count;
}

void mean_and_deviation(const float *values, size_t count, double *mean, double *deviation)
{
    double sum = 0.0;
    *mean = mean_of(values, count);
    for (size_t i = 0; i < count; i++) {
        const double difference = (double)values[i] - *mean;
        sum += difference * difference;
    }
    *deviation = sqrt(sum / (double)count);
}

double median_of(double *values, size_t count)
{
    qsort(values, count, sizeof *values, compare_doubles);
    return count % 2 ? values[count / 2] : 0.5 * (values[count / 2 - 1] + values[count / 2]);
}

void spread_of(double *values, size_t count, double spread[3])
{
    spread[1] = median_of(values, count);
    spread[0] = values[(size_t)(0.05 * (double)(count - 1) + 0.5)];
    spread[2] = values[(size_t)(0.95 * (double)(count - 1) + 0.5)];
}

/* Returns a whole number that grows with the float. */
static uint32_t order_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits & SIGN_BIT ? ~bits : bits | SIGN_BIT;
}

/* Sorts by some bits, and keeps the order where these are equal. */
static void sort_by_bits(const uint32_t *from, size_t count, int shift, uint32_t *to)
{
    size_t places[SORT_BINS + 1] = {0};
    for (size_t i = 0; i < count; i++)
        places[(from[i] >> shift) % SORT_BINS + 1]++;
    for (size_t bin = 1; bin < SORT_BINS; bin++)
        places[bin] += places[bin - 1];
    for (size_t i = 0; i < count; i++)
        to[places[(from[i] >> shift) % SORT_BINS]++] = from[i];
}

/* Returns the ranks of values over their mean, ascending; NULL where memory is out. Goes by floats,
 * so that grey levels that differ by a factor alone stay equal. */
static uint32_t *sorted_over_mean(const float *values, size_t count)
{
    const double mean = mean_of(values, count);
    uint32_t *sorted = allocate_array(count, sizeof *sorted);
    uint32_t *scratch = allocate_array(count, sizeof *scratch);
    for (size_t i = 0; sorted && scratch && i < count; i++)
        scratch[i] = order_of(0.0f + (mean != 0.0 ? (float)((double)values[i] / mean) : values[i]));
    if (sorted && scratch) {
        sort_by_bits(scratch, count, 0, sorted);
        sort_by_bits(sorted, count, SORT_BITS, scratch);
        sort_by_bits(scratch, count, 2 * SORT_BITS, sorted);
    }
    if (!scratch) {
        free(sorted);
        sorted = NULL;
    }
    free(scratch);
    return sorted;
}

static double largest_distance(const uint32_t *a, const uint32_t *b, size_t count)
{
    size_t in_a = 0; /* number of values up to the current one */
    size_t in_b = 0;
    size_t largest = 0;
    while (in_a < count && in_b < count) {
        const uint32_t value = a[in_a] < b[in_b] ? a[in_a] : b[in_b];
        while (in_a < count && a[in_a] <= value)
            in_a++;
        while (in_b < count && b[in_b] <= value)
            in_b++;
        const size_t distance = in_a > in_b ? in_a - in_b : in_b - in_a;
        if (distance > largest)
            largest = distance;
    }
    return (double)largest / (double)count;
}

sonject_status histogram_distance(struct report *report, const float *a, const float *b,
                                  size_t count, double *distance)
{
    *distance = 0.0;
    if (count == 0)
        return SONJECT_OK;
    uint32_t *sorted_a = sorted_over_mean(a, count);
    uint32_t *sorted_b = sorted_over_mean(b, count);
    const bool is_complete = sorted_a && sorted_b;
    if (is_complete)
        *distance = largest_distance(sorted_a, sorted_b, count);
    free(sorted_a);
    free(sorted_b);
    CHECK_MEMORY(report, is_complete, "a histogram");
    return SONJECT_OK;
}

double correlation(const float *a, const float *b, size_t count)
{
    if (count == 0)
        return 0.0;
    const double mean_a = mean_of(a, count);
    const double mean_b = mean_of(b, count);
    double aa = 0.0;
    double bb = 0.0;
    double ab = 0.0;
    for (size_t i = 0; i < count; i++) {
        const double x = (double)a[i] - mean_a;
        const double y = (double)b[i] - mean_b;
        aa += x * x;
        bb += y * y;
        ab += x * y;
    }
    return aa > 0.0 && bb > 0.0 ? ab / (sqrt(aa) * sqrt(bb)) : 0.0;
}
