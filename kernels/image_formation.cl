/* Entry points of image formation. */
#include "image_formation.h"

/* Draws sqrt(energy) * complex normal deviates. Global size: groups of WIDTH bins x strips. */
__kernel void draw_speckle(__global const float *energy, int bins, int first_bin, int first_strip,
                           uint seed_low, uint seed_high, uint stream, __global float *out_real,
                           __global float *out_imaginary)
{
    const int strip = (int)get_global_id(1);
    const struct random_key key =
        random_key_of(seed_low, seed_high, stream, (RECORD_WORD)(first_strip + strip));
    const int first = (int)get_global_id(0) * WIDTH;
    vfloat a, b;
    complex_normal(key, SPLAT_WORD((RECORD_WORD)(first_bin + first)) + LANE_NUMBERS, &a, &b);
    float lanes_a[WIDTH], lanes_b[WIDTH];
    STORE_VFLOAT(a, lanes_a);
    STORE_VFLOAT(b, lanes_b);
    for (int lane = 0; lane < WIDTH && first + lane < bins; lane++) {
        const LONG_INDEX at = (LONG_INDEX)strip * bins + first + lane;
        const float amplitude = ROOT_OF_ONE(energy[at]);
        out_real[at] = amplitude * lanes_a[lane];
        out_imaginary[at] = amplitude * lanes_b[lane];
    }
}

/* Sorts the bins of lines one behind the other, from first_line on. A sorted line is stride *
 * bins_per_pixel long. Global size: groups of WIDTH columns x strips. */
__kernel void sort_bins(__global const float *lines, __global const struct filled_span *filled,
                        int first_line, int bins, int first, int bins_per_pixel, int stride,
                        __global float *sorted)
{
    const LONG_INDEX strip = (LONG_INDEX)get_global_id(1);
    sort_bins_of(lines + (first_line + strip) * bins, bins, filled[first_line + strip], first,
                 bins_per_pixel, stride, (int)get_global_id(0) * WIDTH,
                 sorted + strip * stride * bins_per_pixel);
}

/* Global size: groups of WIDTH columns x strips x planes. */
__kernel void compress_range(__global const float *sorted_real,
                             __global const float *sorted_imaginary, int sorted_stride,
                             __global const struct filled_span *filled, int first_line, int first,
                             int bins_per_pixel, __global const float *pulse, int taps, int stride,
                             int first_out_strip, __global float *out_real,
                             __global float *out_imaginary)
{
    const LONG_INDEX strip = (LONG_INDEX)get_global_id(1);
    __global const float *sorted = get_global_id(2) ? sorted_imaginary : sorted_real;
    __global float *out = get_global_id(2) ? out_imaginary : out_real;
    compress_range_of(sorted + strip * sorted_stride * bins_per_pixel, sorted_stride,
                      filled[first_line + strip], first, bins_per_pixel, pulse, taps,
                      (int)get_global_id(0) * WIDTH, out + (strip + first_out_strip) * stride);
}

/* Global size: groups of WIDTH columns x strips. */
__kernel void compress_range_complex(
    __global const float *sorted_real, __global const float *sorted_imaginary, int sorted_stride,
    __global const struct filled_span *filled, int first_line, int first, int bins_per_pixel,
    __global const float *pulse_real, __global const float *pulse_imaginary, int taps, int stride,
    int first_out_strip, __global float *out_real, __global float *out_imaginary)
{
    const LONG_INDEX strip = (LONG_INDEX)get_global_id(1);
    const LONG_INDEX in = strip * sorted_stride * bins_per_pixel;
    const LONG_INDEX out = (strip + first_out_strip) * stride;
    compress_complex_of(sorted_real + in, sorted_imaginary + in, sorted_stride,
                        filled[first_line + strip], first, bins_per_pixel, pulse_real,
                        pulse_imaginary, taps, (int)get_global_id(0) * WIDTH, out_real + out,
                        out_imaginary + out);
}

/* Global size: groups of WIDTH columns x groups of FORM_ROWS rows x planes. */
__kernel void combine_aspects(int first_strip, int end_strip, int strips_per_row, int reach,
                              __global const float *lines_real,
                              __global const float *lines_imaginary,
                              __global const struct filled_span *filled, int stride,
                              __global const float *response, int rows, __global float *out_real,
                              __global float *out_imaginary)
{
    const struct aspects aspects = {first_strip, end_strip, strips_per_row, reach};
    combine_aspects_of(aspects, get_global_id(2) ? lines_imaginary : lines_real, filled, stride,
                       response, (int)get_global_id(1) * FORM_ROWS, rows,
                       (int)get_global_id(0) * WIDTH, get_global_id(2) ? out_imaginary : out_real);
}

/* Global size: groups of WIDTH columns x groups of FORM_ROWS rows from first_row on. */
__kernel void combine_varied(int first_strip, int end_strip, int strips_per_row, int reach,
                             int first_row, int row_step, int columns_per_block, int block_step,
                             __global const float *lines_real,
                             __global const float *lines_imaginary,
                             __global const struct filled_span *filled, int stride,
                             __global const float *response_real,
                             __global const float *response_imaginary, int rows,
                             __global float *out_real, __global float *out_imaginary)
{
    const struct aspects aspects = {first_strip, end_strip, strips_per_row, reach};
    const struct response_set set = {first_row, row_step, columns_per_block, block_step};
    combine_varied_of(aspects, set, lines_real, lines_imaginary, filled, stride, response_real,
                      response_imaginary, first_row + (int)get_global_id(1) * FORM_ROWS, rows,
                      (int)get_global_id(0) * WIDTH, out_real, out_imaginary);
}
