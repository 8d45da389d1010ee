#include "image/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define BLOCK_LEAST    16   /* least side of a block, pixels, in regions smaller than a block */
#define KEPT_LEAST     0.75 /* least share of a block's pixels that count */
#define TREND_LEAST    0.2  /* least trend, over the mean */
#define TEXTURE_LAG    5    /* only texture is left from this lag on, speckle is uncorrelated */
#define CONTRAST_LEAST 0.01 /* least squared contrast of speckle */

#define PILE_LEAST 16   /* fewest pixels that make a pile */
#define PILE_RATIO 8    /* pixels of a pile over those of the next value */
#define RUN        1024 /* pixels that are looked at together */

/* The values of a block: contrast of the amplitudes, and covariances of the intensities over the
 * square of their mean, for lags along either axis. */
#define AMPLITUDE_CONTRAST 0
#define ROW_LAG(lag)       (1 + (lag))
#define COLUMN_LAG(lag)    (1 + SPECKLE_LAGS + (lag))
#define BLOCK_VALUES       (1 + 2 * SPECKLE_LAGS)

struct block_view {
    const float *intensity;
    const uint8_t *excluded;
    size_t rows, columns, stride;
};

static bool is_kept(const struct block_view *block, size_t at)
{
    return !block->excluded || !block->excluded[at];
}

/* Divides the block's intensity by its own linear trend in rows and columns, to mean 1. Excluded
 * pixels become negative. Returns false where too few pixels count, or all are 0. */
static bool take_trend_off(const struct block_view *block,
                           double values[SPECKLE_BLOCK * SPECKLE_BLOCK])
{
    const double middle_row = 0.5 * (double)(block->rows - 1);
    const double middle_column = 0.5 * (double)(block->columns - 1);
    double sum = 0.0;
    double sums[2] = {0.0, 0.0};
    double squares[2] = {0.0, 0.0};
    size_t kept = 0;
    for (size_t i = 0; i < block->rows * block->columns; i++) {
        const size_t at = i / block->columns * block->stride + i % block->columns;
        const double down = (double)(i / block->columns) - middle_row;
        const double right = (double)(i % block->columns) - middle_column;
        values[i] = is_kept(block, at) ? (double)block->intensity[at] : -1.0;
        if (values[i] < 0.0)
            continue;
        sum += values[i];
        sums[0] += down * values[i];
        sums[1] += right * values[i];
        squares[0] += down * down;
        squares[1] += right * right;
        kept++;
    }
    if ((double)kept < KEPT_LEAST * (double)(block->rows * block->columns) || !(sum > 0.0))
        return false;
    const double mean = sum / (double)kept;
    double left = 0.0;
    for (size_t i = 0; i < block->rows * block->columns; i++) {
        const double down = (double)(i / block->columns) - middle_row;
        const double right = (double)(i % block->columns) - middle_column;
        const double trend = mean + sums[0] / squares[0] * down + sums[1] / squares[1] * right;
        values[i] /= fmax(trend, TREND_LEAST * mean);
        left += values[i] >= 0.0 ? values[i] / (double)kept : 0.0;
    }
    for (size_t i = 0; i < block->rows * block->columns; i++)
        values[i] /= left;
    return true;
}

/* Returns the covariance of values of mean 1 at these lags, over pairs that both count. */
static double covariance_of(const struct block_view *block, const double *values, size_t row_lag,
                            size_t column_lag)
{
    double sum = 0.0;
    size_t pairs = 0;
    for (size_t row = 0; row + row_lag < block->rows; row++)
        for (size_t column = 0; column + column_lag < block->columns; column++) {
            const double a = values[row * block->columns + column];
            const double b = values[(row + row_lag) * block->columns + column + column_lag];
            if (a < 0.0 || b < 0.0)
                continue;
            sum += (a - 1.0) * (b - 1.0);
            pairs++;
        }
    return pairs > 0 ? sum / (double)pairs : 0.0;
}

static bool measure_block(const struct block_view *block, double results[BLOCK_VALUES])
{
    double values[SPECKLE_BLOCK * SPECKLE_BLOCK];
    double amplitude = 0.0;
    double intensity = 0.0;
    double kept = 0.0;
    if (!take_trend_off(block, values))
        return false;
    for (size_t i = 0; i < block->rows * block->columns; i++) {
        if (values[i] < 0.0)
            continue;
        amplitude += sqrt(values[i]);
        intensity += values[i];
        kept += 1.0;
    }
    results[AMPLITUDE_CONTRAST] = sqrt(fmax(0.0, intensity * kept / (amplitude * amplitude) - 1.0));
    for (size_t lag = 0; lag < SPECKLE_LAGS; lag++) {
        results[ROW_LAG(lag)] = covariance_of(block, values, lag, 0);
        results[COLUMN_LAG(lag)] = covariance_of(block, values, 0, lag);
    }
    return true;
}

/* Returns the median of one value over the blocks. *error gets its standard error from the median
 * deviation, as for normal values: 1.2533 * 1.4826 times that over sqrt(count). scratch: count. */
static double block_median(const double *blocks, size_t count, size_t value, double *scratch,
                           double *error)
{
    for (size_t i = 0; i < count; i++)
        scratch[i] = blocks[i * BLOCK_VALUES + value];
    const double median = median_of(scratch, count);
    for (size_t i = 0; i < count; i++)
        scratch[i] = fabs(blocks[i * BLOCK_VALUES + value] - median);
    *error = 1.2533 * 1.4826 * median_of(scratch, count) / sqrt((double)count);
    return median;
}

/* Returns the texture's covariance: what is left at large lags. */
static double texture_of(const double covariance[SPECKLE_LAGS])
{
    double sum = 0.0;
    for (size_t lag = TEXTURE_LAG; lag < SPECKLE_LAGS; lag++)
        sum += covariance[lag];
    return fmax(0.0, sum / (double)(SPECKLE_LAGS - TEXTURE_LAG));
}

/* Returns the speckle's share of a second moment 1 + covariance, with texture divided out. */
static double speckle_of(double covariance, double texture)
{
    return (1.0 + covariance) / (1.0 + texture) - 1.0;
}

static void fill_axis(const double covariance[SPECKLE_LAGS], double lag_one_error,
                      struct speckle_axis *axis)
{
    const double texture = texture_of(covariance);
    const double speckle = fmax(1e-3, speckle_of(covariance[0], texture));
    for (size_t lag = 0; lag < SPECKLE_LAGS; lag++)
        axis->correlation[lag] =
            fmin(1.0, fmax(0.0, speckle_of(covariance[lag], texture) / speckle));
    axis->lag_one_error = lag_one_error / (1.0 + texture) / speckle;
    const double edge = exp(-1.0) * covariance[0];
    size_t lag = 1;
    while (lag < SPECKLE_LAGS && covariance[lag] > edge)
        lag++;
    axis->length_pixels =
        lag == SPECKLE_LAGS
            ? SPECKLE_LAGS - 1
            : (double)lag - (edge - covariance[lag]) / (covariance[lag - 1] - covariance[lag]);
}

static void summarise(const double *blocks, size_t count, double *scratch,
                      struct speckle_statistics *statistics)
{
    double along[SPECKLE_LAGS], range[SPECKLE_LAGS];
    double error, contrast_error, along_error, range_error;
    statistics->amplitude_contrast =
        block_median(blocks, count, AMPLITUDE_CONTRAST, scratch, &error);
    const double contrast = block_median(blocks, count, ROW_LAG(0), scratch, &contrast_error);
    for (size_t lag = 0; lag < SPECKLE_LAGS; lag++) {
        along[lag] = block_median(blocks, count, ROW_LAG(lag), scratch, &error);
        range[lag] = block_median(blocks, count, COLUMN_LAG(lag), scratch, &error);
    }
    block_median(blocks, count, ROW_LAG(1), scratch, &along_error);
    block_median(blocks, count, COLUMN_LAG(1), scratch, &range_error);
    if (!(contrast > CONTRAST_LEAST))
        return;
    const double texture = 0.5 * (texture_of(along) + texture_of(range));
    const double speckle = fmax(1e-3, speckle_of(contrast, texture));
    statistics->blocks = count;
    statistics->intensity_contrast = sqrt(contrast);
    statistics->looks = fmax(1.0, 1.0 / speckle);
    statistics->looks_error = contrast_error / (1.0 + texture) / (speckle * speckle);
    const double inverse_shape = (1.0 + contrast) / (1.0 + 1.0 / statistics->looks) - 1.0;
    statistics->shape = inverse_shape > 1e-3 ? 1.0 / inverse_shape : INFINITY;
    fill_axis(along, along_error, &statistics->along_track);
    fill_axis(range, range_error, &statistics->range);
}

sonject_status measure_speckle(struct report *report, const float *intensity,
                               const uint8_t *excluded, size_t rows, size_t columns, size_t stride,
                               struct speckle_statistics *statistics)
{
    memset(statistics, 0, sizeof *statistics);
    const size_t high = smaller_size(SPECKLE_BLOCK, rows);
    const size_t wide = smaller_size(SPECKLE_BLOCK, columns);
    if (high < BLOCK_LEAST || wide < BLOCK_LEAST)
        return SONJECT_OK;
    const size_t most = (rows / high) * (columns / wide);
    double *blocks = allocate_array(most, BLOCK_VALUES * sizeof *blocks);
    double *scratch = allocate_array(most, sizeof *scratch);
    size_t count = 0;
    for (size_t i = 0; blocks && scratch && i < most; i++) {
        const size_t at = i / (columns / wide) * high * stride + i % (columns / wide) * wide;
        const struct block_view block = {intensity + at, excluded ? excluded + at : NULL, high,
                                         wide, stride};
        count += measure_block(&block, blocks + count * BLOCK_VALUES);
    }
    const bool is_out_of_memory = !blocks || !scratch;
    if (count > 0)
        summarise(blocks, count, scratch, statistics);
    free(blocks);
    free(scratch);
    return is_out_of_memory ? report_out_of_memory(report, "speckle statistics") : SONJECT_OK;
}

double find_saturation(const float *amplitudes, size_t count)
{
    float largest = 0.0f;
    float next = 0.0f;
    size_t at_largest = 0;
    size_t at_next = 0;
    for (size_t i = 0; i < count; i++) {
        /* Most runs have no pixel that counts. The compiler looks at several of these at once. */
        while (i % RUN == 0 && count - i > RUN) {
            bool counts = false;
            for (size_t k = 0; k < RUN; k++)
                counts |= amplitudes[i + k] >= next;
            if (counts)
                break;
            i += RUN;
        }
        if (amplitudes[i] > largest) {
            next = largest;
            at_next = at_largest;
            largest = amplitudes[i];
            at_largest = 0;
        } else if (amplitudes[i] < largest && amplitudes[i] > next) {
            next = amplitudes[i];
            at_next = 0;
        }
        at_largest += amplitudes[i] == largest;
        at_next += amplitudes[i] == next;
    }
    const bool is_pile =
        at_largest >= PILE_LEAST && at_largest > PILE_RATIO * at_next && at_largest < count / 2;
    return is_pile ? (double)largest : INFINITY;
}
