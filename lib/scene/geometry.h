/* Where the pixels of a swath lie, and what a table tells of it row by row. */
#ifndef SONJECT_SCENE_GEOMETRY_H
#define SONJECT_SCENE_GEOMETRY_H

#include <stddef.h>

#include "scene/params.h"

#define PING_ROWS_MAX ((size_t)1 << 20)

/* Of rows of a swath; linear between them. All zeros: there is none. */
struct ping_table {
    double *rows;           /* owned, with the others behind it; they rise */
    double *altitudes_m;    /* above 0 */
    double *first_ranges_m; /* from 0, of column 0; NULL: they are not told */
    size_t count;           /* 0, or at least 2 */
};

/* The column's value at a row within the table's. */
double ping_table_at(const struct ping_table *table, const double *column, double row);

void ping_table_clear(struct ping_table *table);

#endif
