/* The column at which the seabed begins, behind the water column, in each ping of a waterfall. */
#ifndef SONJECT_MEASURE_FIRST_RETURN_H
#define SONJECT_MEASURE_FIRST_RETURN_H

#include <stdbool.h>
#include <stddef.h>

#include "base/report.h"

/* Finds the first column of the seabed in each row of intensities. Range grows to the right from
 * column 0. The water column must be 10 dB darker than the seabed from where the transmitted pulse
 * has died down. A row without a water column gets the result of the row before, or of the first
 * that has one. All are 0 where fewer than nine in ten rows have one. Errors: MEMORY. */
sonject_status find_first_return(struct report *report, const float *intensity, size_t rows,
                                 size_t columns, size_t *first_columns);

/* The sides that a waterfall shows, and where the water column lies. */
enum water_sides {
    WATER_UNSEEN,   /* no water column */
    WATER_AT_LEFT,  /* range grows to the right from the first column */
    WATER_AT_RIGHT, /* range grows to the left from the last one */
    WATER_BETWEEN   /* two sides, the nadir between them */
};

struct first_returns {
    enum water_sides sides;
    double nadir_column;       /* column of range 0; NAN: unseen; the image's edge for one side */
    double nadir_column_error; /* standard error */
    double *columns; /* columns from nadir to seabed in each row, the mean of two sides; NULL:
                        unseen; owned */
};

/* Finds which sides a waterfall shows, and its first returns. Errors: MEMORY. */
sonject_status first_returns_find(struct first_returns *returns, struct report *report,
                                  const float *intensity, size_t rows, size_t columns);

/* A rectangle of an image's pixels. first_returns_cover returns whether any of them lies in the
 * water column or at its end. columns: the image's width. */
struct water_place {
    size_t row, column, rows, columns;
};
bool first_returns_cover(const struct first_returns *returns, const struct water_place *place,
                         size_t columns);

void first_returns_clear(struct first_returns *returns);

#endif
