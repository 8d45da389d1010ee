/* Entry points of the element level. */
#include "element_series.h"

/* Global size: segments x pairs of transmitter and hydrophone. Real and imaginary lines are apart,
 * each pairs x stride. */
__kernel void hear_elements(__global const struct impulse_grid_record *grid_buffer,
                            __global const struct element_pair_record *pairs,
                            __global const int *starts, __global const int *bins,
                            __global const float *impulses_real,
                            __global const float *impulses_imaginary, int stride,
                            __global float *lines_real, __global float *lines_imaginary)
{
    const struct impulse_grid_record grid = *grid_buffer;
    const struct element_pair_record pair = pairs[get_global_id(1)];
    const LONG_INDEX at = (LONG_INDEX)get_global_id(1) * stride;
    hear_grid(&grid, &pair, starts, bins, impulses_real, impulses_imaginary, (int)get_global_id(0),
              lines_real + at, lines_imaginary + at);
}

/* Global size: groups of WIDTH samples x pairs. Series: pairs x series_stride. */
__kernel void pulse_elements(__global const float *lines_real,
                             __global const float *lines_imaginary, int stride, int fine,
                             __global const float *pulse_real,
                             __global const float *pulse_imaginary, int taps, int series_stride,
                             __global float *series_real, __global float *series_imaginary)
{
    const LONG_INDEX line = (LONG_INDEX)get_global_id(1) * stride;
    const LONG_INDEX series = (LONG_INDEX)get_global_id(1) * series_stride;
    pulse_series(lines_real + line, lines_imaginary + line, fine, pulse_real, pulse_imaginary, taps,
                 (int)get_global_id(0) * WIDTH, series_real + series, series_imaginary + series);
}
