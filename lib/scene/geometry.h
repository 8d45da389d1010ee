/* Where the pixels of a swath lie, and what a table tells of it row by row. */
#ifndef SONJECT_SCENE_GEOMETRY_H
#define SONJECT_SCENE_GEOMETRY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/params.h"

/* Whether range grows towards column 0. */
bool geometry_is_reversed(const sonject_geometry_params *geometry);

/* Slant range in m of a column of the swath, which may be fractional, and the reverse; on the other
 * side of a nadir column ranges are less than that column's. */
double geometry_range(const sonject_geometry_params *geometry, double column);
double geometry_column(const sonject_geometry_params *geometry, double range_m);

/* The columns on the imaged side of a swath of so many; false if there are none, or if the nadir
 * column is none of them. */
bool geometry_side(const sonject_geometry_params *geometry, uint64_t columns, uint64_t *first,
                   uint64_t *count);

/* Of an image by itself that is so many columns of the swath, from a row and a column on. */
sonject_geometry_params geometry_crop(const sonject_geometry_params *geometry, double first_row,
                                      double first_column, double columns);

#define PING_ROWS_MAX ((size_t)1 << 20)

/* Of rows of a swath; linear between them. All zeros: there is none. */
struct ping_table {
    double *rows;           /* owned, with the others behind it; they rise */
    double *altitudes_m;    /* above 0 */
    double *first_ranges_m; /* from 0, of column 0; NULL: they are not told */
    size_t count;           /* 0, or at least 2 */
};

/* Where the seabed begins in each `every`th row of a swath, in columns from the nadir, or from the
 * first column where range does not begin at a nadir. All zeros: it is not known. */
struct first_return_list {
    double *columns; /* owned */
    size_t count, every;
};

/* Who tells the altitude at a row. */
enum altitude_source {
    ALTITUDE_GIVEN,     /* the scene, one for all rows */
    ALTITUDE_RECORDED,  /* from_file: a table of pings, or else the input file */
    ALTITUDE_OF_RETURNS /* first_return: the calibration */
};

/* The slant range of the first return in a row that the list has, m. */
double first_return_range(const struct first_return_list *returns,
                          const sonject_geometry_params *geometry, uint64_t row);

/* The column's value at a row within the table's. */
double ping_table_at(const struct ping_table *table, const double *column, double row);

void ping_table_clear(struct ping_table *table);

#endif
