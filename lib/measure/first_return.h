/* Where the water column of a sidescan image ends: before the first return there is no contact on
 * the seabed, and that return is none itself. */
#ifndef SONJECT_MEASURE_FIRST_RETURN_H
#define SONJECT_MEASURE_FIRST_RETURN_H

#include <stddef.h>

#include "base/report.h"

/* The first column of the seabed, for each row; all 0 where not nearly all rows begin with a water
 * column: darker than the seabed by 10 dB from where the transmitted pulse has died down.
 * first_columns: rows. Errors: MEMORY. */
sonject_status find_first_return(struct report *report, const float *intensity, size_t rows,
                                 size_t columns, size_t *first_columns);

#endif
