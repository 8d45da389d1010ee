/* The places of a swath's pixels, and tables of values for its rows. */
#ifndef SONJECT_SCENE_GEOMETRY_H
#define SONJECT_SCENE_GEOMETRY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/params.h"

/* Returns whether range grows towards column 0. */
bool geometry_is_reversed(const sonject_geometry_params *geometry);

/* Convert a column of the swath, which may be fractional, to slant range in m, and back. On the
 * other side of a nadir column, ranges are less than that column's. */
double geometry_range(const sonject_geometry_params *geometry, double column);
double geometry_column(const sonject_geometry_params *geometry, double range_m);

/* Finds the imaged side's columns in a swath of so many. Returns false if there are none, or if the
 * nadir column is outside. */
bool geometry_side(const sonject_geometry_params *geometry, uint64_t columns, uint64_t *first,
                   uint64_t *count);

/* Returns the geometry of an image that begins at a row and column of the swath, columns wide. */
sonject_geometry_params geometry_crop(const sonject_geometry_params *geometry, double first_row,
                                      double first_column, double columns);

#define PING_ROWS_MAX ((size_t)1 << 20)

/* Altitudes and first ranges at rows of a swath, linear between these. All zeros: no table. */
struct ping_table {
    double *rows;           /* owned, rising; its memory holds the others */
    double *altitudes_m;    /* m, above 0 */
    double *first_ranges_m; /* m, from 0, of column 0; NULL: not given */
    size_t count;           /* 0, or at least 2 */
};

/* A calibration's `sides` of an image whose one side begins at the right edge. */
#define LEFTWARD_SIDES "one, range grows to the left"

/* The column at which the seabed begins in each `every`th row, counted from the nadir, or from the
 * first column where range does not begin at a nadir. All zeros: not known. */
struct first_return_list {
    double *columns; /* owned */
    size_t count, every;
    double edge; /* nadir that the columns count from, the image's right edge, if range grows to the
                    left on one side; 0: another nadir */
};

/* The source of the altitude at a row. */
enum altitude_source {
    ALTITUDE_GIVEN,     /* the scene: one for all rows */
    ALTITUDE_RECORDED,  /* from_file: a table of pings, or else the input file */
    ALTITUDE_OF_RETURNS /* first_return: the calibration */
};

/* Returns the slant range of the first return in a row that the list has, m. */
double first_return_range(const struct first_return_list *returns,
                          const sonject_geometry_params *geometry, uint64_t row);

/* Returns a column's value at a row within the table. */
double ping_table_at(const struct ping_table *table, const double *column, double row);

void ping_table_clear(struct ping_table *table);

#endif
