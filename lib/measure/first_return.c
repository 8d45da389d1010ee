#include "measure/first_return.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/statistics.h"

#define WINDOW        24   /* columns on either side of the step */
#define ROWS_AVERAGED 2    /* neighbours on either side: 120 samples of speckle err by 0.5 dB */
#define PULSE         16   /* first columns, which may hold the transmitted pulse */
#define STEP_DB       10.0 /* least step from water to seabed */
#define FAINTEST      1e-30f
#define FAINTEST_DB   (-300.0)
#define SAMPLES       4096 /* pixels that tell the image's median */
#define DARKEST       1e-4 /* least intensity that counts, over the median: 40 dB below */
#define WATER_MARGIN  8.0  /* columns behind the first return that are not plain seabed yet */
#define PROFILE_ROWS  200  /* most rows that tell where to look for the nadir */
#define NADIR_SPREAD  4.0  /* columns; most that the middle between both sides may vary */
#define ROWS_SHARE    0.9  /* least share of rows with a first return; shadows hide some */

/* Returns the least intensity that counts, 40 dB below the median of the pixels above 0. A lone
 * pixel of grey level 1 among zeros would be a step to the seabed otherwise. */
static float darkest_intensity(const float *intensity, size_t count)
{
    double samples[SAMPLES];
    const uint64_t golden = UINT64_C(11400714819323198485); /* 2^64 over the golden ratio */
    size_t found = 0;
    for (uint64_t k = 0; count > 0 && k < SAMPLES; k++) {
        /* places spread evenly, whatever the length of a row */
        const size_t i = (size_t)ldexp((double)(k * golden >> 11) * (double)count, -53);
        if (intensity[i] > FAINTEST)
            samples[found++] = (double)intensity[i];
    }
    return found > 0 ? fmaxf(FAINTEST, (float)(DARKEST * median_of(samples, found))) : FAINTEST;
}

/* Fills sums[j] with the sum of the levels before column j, dB, averaged over a row and its
 * neighbours. Levels are averaged, not intensities, since fish and spikes are bright. */
static void sum_levels(const float *levels, size_t rows, size_t columns, size_t row, double *sums)
{
    const size_t first = row > ROWS_AVERAGED ? row - ROWS_AVERAGED : 0;
    const size_t end = row + ROWS_AVERAGED < rows ? row + ROWS_AVERAGED + 1 : rows;
    sums[0] = 0.0;
    for (size_t column = 0; column < columns; column++) {
        double level = 0.0;
        for (size_t r = first; r < end; r++)
            level += (double)levels[r * columns + column];
        sums[column + 1] = sums[column] + level / (double)(end - first);
    }
}

static double mean_level(const double *sums, size_t first, size_t columns)
{
    return (sums[first + columns] - sums[first]) / (double)columns;
}

static double step_at(const double *sums, size_t column)
{
    return mean_level(sums, column, WINDOW) - mean_level(sums, column - WINDOW, WINDOW);
}

/* Returns the column of the first high step, where it is largest; 0: none, or bright before it. */
static size_t first_step(const double *sums, size_t columns)
{
    size_t found = 0;
    double largest = STEP_DB;
    double brightest = FAINTEST_DB; /* window within the water column */
    for (size_t column = PULSE + WINDOW; column + WINDOW <= columns; column++) {
        const double step = step_at(sums, column);
        if (step >= largest) {
            largest = step;
            found = column;
        } else if (found > 0 && column > found + WINDOW) {
            break;
        }
    }
    for (size_t column = PULSE; found > 0 && column + WINDOW <= found; column++)
        brightest = fmax(brightest, mean_level(sums, column, WINDOW));
    return found > 0 && mean_level(sums, found, WINDOW) > brightest + 0.5 * STEP_DB ? found : 0;
}

sonject_status find_first_return(struct report *report, const float *intensity, size_t rows,
                                 size_t columns, size_t *first_columns)
{
    double *sums = allocate_array(columns + 1, sizeof *sums);
    float *levels = allocate_array(rows, columns * sizeof *levels);
    size_t last = 0;
    size_t missing = 0;
    const bool is_complete = sums && levels;
    const float darkest = darkest_intensity(intensity, rows * columns);
    for (size_t i = 0; is_complete && i < rows * columns; i++)
        levels[i] = 10.0f * log10f(fmaxf(darkest, intensity[i]));
    for (size_t row = 0; is_complete && row < rows; row++) {
        sum_levels(levels, rows, columns, row, sums);
        const size_t column = first_step(sums, columns);
        missing += column == 0;
        if ((double)missing > (1.0 - ROWS_SHARE) * (double)rows)
            break;
        for (size_t above = 0; last == 0 && above < row; above++)
            first_columns[above] = column;
        last = column > 0 ? column : last;
        first_columns[row] = last;
    }
    if ((double)missing > (1.0 - ROWS_SHARE) * (double)rows)
        memset(first_columns, 0, rows * sizeof *first_columns);
    free(levels);
    free(sums);
    CHECK_MEMORY(report, is_complete, "the water column");
    return SONJECT_OK;
}

bool first_returns_cover(const struct first_returns *returns, const struct water_place *place,
                         size_t columns)
{
    const double left = (double)place->column, right = left + (double)place->columns;
    for (size_t row = place->row; returns->columns && row < place->row + place->rows; row++) {
        const double water = returns->columns[row] + WATER_MARGIN;
        if (returns->sides == WATER_AT_LEFT ? left < water
            : returns->sides == WATER_AT_RIGHT
                ? right > (double)columns - water
                : left < returns->nadir_column + water && right > returns->nadir_column - water)
            return true;
    }
    return false;
}

void first_returns_clear(struct first_returns *returns)
{
    free(returns->columns);
    memset(returns, 0, sizeof *returns);
}

/* Finds first returns in count columns from first on; range grows to the left if is_mirrored. */
static sonject_status find_side(struct report *report, const float *intensity, size_t rows,
                                size_t stride, size_t first, size_t count, bool is_mirrored,
                                size_t *first_columns)
{
    float *side = allocate_array(rows, count * sizeof *side);
    CHECK_MEMORY(report, side, "the water column");
    for (size_t row = 0; row < rows; row++)
        for (size_t k = 0; k < count; k++)
            side[row * count + k] =
                intensity[row * stride + (is_mirrored ? first + count - 1 - k : first + k)];
    const sonject_status status = find_first_return(report, side, rows, count, first_columns);
    free(side);
    return status;
}

/* Finds the middle of the darkest columns of some: those around the darkest one whose mean levels
 * over the rows are nearer to its level than to the median of all columns. A transmitted pulse
 * among them counts, too. */
static sonject_status find_darkest(struct report *report, const float *intensity, size_t rows,
                                   size_t columns, size_t first_column, size_t end_column,
                                   size_t *middle)
{
    const size_t stride = rows / PROFILE_ROWS + 1;
    double *profile = allocate_array(columns, 2 * sizeof *profile);
    double *sorted = profile + columns;
    const float least = darkest_intensity(intensity, rows * columns);
    size_t darkest = first_column;
    CHECK_MEMORY(report, profile, "the water column");
    for (size_t row = 0; row < rows; row += stride)
        for (size_t column = 0; column < columns; column++)
            profile[column] += log((double)fmaxf(least, intensity[row * columns + column]));
    memcpy(sorted, profile, columns * sizeof *profile);
    qsort(sorted, columns, sizeof *sorted, compare_doubles);
    for (size_t column = first_column; column < end_column; column++)
        if (profile[column] < profile[darkest])
            darkest = column;
    const double edge = 0.5 * (profile[darkest] + sorted[columns / 2]);
    size_t first = darkest, last = darkest;
    for (size_t column = darkest; column < columns && column <= last + 2 * PULSE; column++)
        last = profile[column] < edge ? column : last;
    for (size_t column = darkest + 1; column-- > 0 && column + 2 * PULSE >= first;)
        first = profile[column] < edge ? column : first;
    *middle = (first + last) / 2;
    free(profile);
    return SONJECT_OK;
}

/* Finds the nadir halfway between both sides' first returns, wherever the search began. */
static sonject_status join_sides(struct first_returns *returns, struct report *report,
                                 const size_t *right, const size_t *left, size_t rows,
                                 size_t middle)
{
    double *halfway = allocate_array(rows, sizeof *halfway);
    CHECK_MEMORY(report, halfway, "the water column");
    for (size_t row = 0; row < rows; row++) {
        halfway[row] = (double)middle - 0.5 + 0.5 * ((double)right[row] - (double)left[row]);
        returns->columns[row] = 0.5 * ((double)right[row] + (double)left[row]);
    }
    qsort(halfway, rows, sizeof *halfway, compare_doubles);
    returns->nadir_column = halfway[rows / 2];
    /* The quartiles of normal values are 1.349 deviations apart. Five rows share a first return. */
    const double spread = (halfway[3 * rows / 4] - halfway[rows / 4]) / 1.349;
    const double rounding = 0.3;
    returns->nadir_column_error =
        1.2533 * hypot(spread, rounding) / sqrt(fmax(1.0, (double)rows / (2 * ROWS_AVERAGED + 1)));
    free(halfway);
    returns->sides = spread < NADIR_SPREAD ? WATER_BETWEEN : WATER_UNSEEN;
    return SONJECT_OK;
}

sonject_status first_returns_find(struct first_returns *returns, struct report *report,
                                  const float *intensity, size_t rows, size_t columns)
{
    size_t middle = 0;
    memset(returns, 0, sizeof *returns);
    returns->nadir_column = NAN;
    size_t *right = allocate_array(rows, sizeof *right);
    size_t *left = allocate_array(rows, sizeof *left);
    returns->columns = allocate_array(rows, sizeof *returns->columns);
    sonject_status status = right && left && returns->columns
                                ? SONJECT_OK
                                : report_out_of_memory(report, "the water column");
    /* far seabed may be darker than the water column: then the nadir is sought about the middle */
    for (size_t attempt = 0; attempt < 2 && rows > 0 && columns > 0 && status == SONJECT_OK &&
                             returns->sides == WATER_UNSEEN;
         attempt++) {
        const size_t margin = attempt * (columns / 4);
        status = find_darkest(report, intensity, rows, columns, margin, columns - margin, &middle);
        THEN(status,
             find_side(report, intensity, rows, columns, middle, columns - middle, false, right));
        THEN(status, find_side(report, intensity, rows, columns, 0, middle, true, left));
        if (status == SONJECT_OK && right[rows - 1] > 0 && left[rows - 1] > 0)
            status = join_sides(returns, report, right, left, rows, middle);
    }
    for (int is_mirrored = 0; is_mirrored < 2 && returns->sides == WATER_UNSEEN; is_mirrored++) {
        THEN(status, find_side(report, intensity, rows, columns, 0, columns, is_mirrored, right));
        if (status != SONJECT_OK || rows == 0 || right[rows - 1] == 0)
            continue;
        returns->sides = is_mirrored ? WATER_AT_RIGHT : WATER_AT_LEFT;
        returns->nadir_column = is_mirrored ? (double)columns - 0.5 : -0.5;
        for (size_t row = 0; row < rows; row++)
            returns->columns[row] = (double)right[row];
    }
    if (returns->sides == WATER_UNSEEN) {
        free(returns->columns);
        returns->columns = NULL;
    }
    free(right);
    free(left);
    if (status != SONJECT_OK)
        first_returns_clear(returns);
    return status;
}
