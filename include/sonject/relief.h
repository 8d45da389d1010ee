/* Heights of the seabed over its mean plane z = 0, given as a grid. */
#ifndef SONJECT_RELIEF_H
#define SONJECT_RELIEF_H

#include <stdint.h>

#include <sonject/export.h>

SONJECT_BEGIN_DECLARATIONS

/* Rows along-track, columns in ground range, which is horizontal from the track. Between the points
 * heights are bilinear, outside the grid they are 0. */
typedef struct sonject_relief_params {
    uint32_t struct_size;
    uint32_t rows;    /* 2...16384, at most 2^24 points; 0: no grid */
    uint32_t columns; /* 2...16384 */
    uint32_t reserved;
    double first_along_track_m;  /* of row 0 */
    double first_ground_range_m; /* of column 0 */
    double row_spacing_m;        /* > 0 */
    double column_spacing_m;     /* > 0 */
} sonject_relief_params;

/* No grid, spacings of 2.5 cm. */
SONJECT_API void sonject_relief_params_init(sonject_relief_params *relief);

SONJECT_END_DECLARATIONS

#endif
