#include "measure/first_return.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define WINDOW      24   /* columns on either side of the step */
#define ROWS_BESIDE 2    /* of a row, that count too: 120 samples of speckle know 0.5 dB */
#define PULSE       16   /* first columns, which may hold the transmitted pulse */
#define STEP_DB     10.0 /* from water to seabed */
#define FAINTEST_DB (-300.0)
#define ROWS_SHARE  0.9 /* of the rows, that must have one: shadows begin with seabed in some */

/* sums[j]: of the levels before column j, dB, in a row and those beside it. Levels are averaged and
 * not intensities, since fish and spikes are bright. */
static void sum_levels(const float *intensity, size_t rows, size_t columns, size_t row,
                       double *sums)
{
    const size_t first = row > ROWS_BESIDE ? row - ROWS_BESIDE : 0;
    const size_t end = row + ROWS_BESIDE < rows ? row + ROWS_BESIDE + 1 : rows;
    sums[0] = 0.0;
    for (size_t column = 0; column < columns; column++) {
        double level = 0.0;
        for (size_t r = first; r < end; r++)
            level += fmax(FAINTEST_DB, 10.0 * log10((double)intensity[r * columns + column]));
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

/* The largest step near the first one that is high enough; 0: all before it is not dark. */
static size_t first_step(const double *sums, size_t columns)
{
    size_t found = 0;
    double largest = STEP_DB;
    double brightest = FAINTEST_DB; /* of the water */
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
    size_t last = 0;
    size_t missing = 0;
    CHECK_MEMORY(report, sums, "the water column");
    for (size_t row = 0; row < rows; row++) {
        sum_levels(intensity, rows, columns, row, sums);
        const size_t column = first_step(sums, columns);
        missing += column == 0;
        for (size_t above = 0; last == 0 && above < row; above++)
            first_columns[above] = column;
        last = column > 0 ? column : last;
        first_columns[row] = last;
    }
    if ((double)missing > (1.0 - ROWS_SHARE) * (double)rows)
        memset(first_columns, 0, rows * sizeof *first_columns);
    free(sums);
    return SONJECT_OK;
}
