/* The seabed's relief as host and device share it: heights over the mean seabed on a level grid,
 * rows along-track, columns in ground range; 0 outside. Four-byte members only. */
#ifndef SONJECT_KERNELS_RELIEF_RECORDS_H
#define SONJECT_KERNELS_RELIEF_RECORDS_H

#include "record_types.h"

#define RELIEF_BLOCK 8 /* cells of a block each way */

/* Behind it lie rows x columns heights (m), as many pairs of slopes (along-track, in range), and
 * block_rows x block_columns pairs of the highest and lowest point of a block. */
struct relief_record {
    RECORD_INT rows, columns; /* grid points, at least 2 each */
    RECORD_INT block_rows, block_columns;
    float rows_per_metre, columns_per_metre;
    float lowest, highest; /* m: a little beyond all heights */
};

#endif
