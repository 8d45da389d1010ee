/* Where the seabed begins in each ping of a sidescan waterfall, behind its water column. */
#ifndef SONJECT_MEASURE_FIRST_RETURN_H
#define SONJECT_MEASURE_FIRST_RETURN_H

#include <stdbool.h>
#include <stddef.h>

#include "base/report.h"

/* The first column of the seabed, for each row of intensities, range growing to the right from
 * column 0; all 0 where not nearly all rows begin with a water column: darker than the seabed by 10
 * dB from where the transmitted pulse has died down. A row that has none is given that of the row
 * before. Errors: MEMORY. */
sonject_status find_first_return(struct report *report, const float *intensity, size_t rows,
                                 size_t columns, size_t *first_columns);

/* How a waterfall lies about its track. */
enum water_sides {
    WATER_UNSEEN,   /* no water column */
    WATER_AT_LEFT,  /* range grows to the right from the first column */
    WATER_AT_RIGHT, /* range grows to the left from the last one */
    WATER_BETWEEN   /* two sides, the nadir between them */
};

struct first_returns {
    enum water_sides sides;
    double nadir_column;       /* where range is 0; NAN: unseen. Of one side it is the edge */
    double nadir_column_error; /* standard error */
    double *columns;           /* from the nadir to the seabed's first pixel, the mean of both sides
                                  where there are two, for each row; NULL: unseen; owned */
};

/* Finds out how a waterfall lies, and its first returns. Errors: MEMORY. */
sonject_status first_returns_find(struct first_returns *returns, struct report *report,
                                  const float *intensity, size_t rows, size_t columns);

/* Whether any of a place's pixels lies in the water column or at its end; columns: the image's. */
struct water_place {
    size_t row, column, rows, columns;
};
bool first_returns_cover(const struct first_returns *returns, const struct water_place *place,
                         size_t columns);

void first_returns_clear(struct first_returns *returns);

#endif
