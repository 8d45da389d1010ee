/* Image formation, from bins to pixels: speckle, pulse, cross-range response. A field is two float
 * planes, its real and imaginary part, or two energies that are formed side by side. Every output
 * is a sum in one fixed order. */
#ifndef SONJECT_KERNELS_IMAGE_FORMATION_H
#define SONJECT_KERNELS_IMAGE_FORMATION_H

#include "elementary.h"
#include "layout.h"
#include "random.h"

/* Draws complex normal deviates of unit mean square by Box and Muller: -ln u is the exponential
 * intensity, v the phase in cycles. */
FUNCTION void complex_normal(struct random_key key, word number, vfloat *real_part,
                             vfloat *imaginary_part)
{
    vfloat u, v;
    two_uniforms(key, number, 0, &u, &v);
    const vfloat amplitude = SQUARE_ROOT(-natural_logarithm(u));
    vfloat sine, cosine;
    sine_cosine_of_cycles(v, &sine, &cosine);
    *real_part = amplitude * cosine;
    *imaginary_part = amplitude * sine;
}

/* Sorts a line's bins so that the bins from which neighbouring pixels take one tap lie side by
 * side. Bin k * bins_per_pixel + phase + first goes to sorted[phase * stride + k], for the WIDTH
 * elements k from `column` on and all phases. Bins outside the line are empty. Elements that lie so
 * far from the filled bins that compression leaves them out stay as they are. */
FUNCTION void sort_bins_of(GLOBAL const float *line, int bins, struct filled_span filled, int first,
                           int bins_per_pixel, int stride, int column, GLOBAL float *sorted)
{
    const int group = WIDTH * bins_per_pixel;
    const int start = column * bins_per_pixel + first;
    const int is_inside = start >= 0 && start + group <= bins;
    if (start + 2 * group <= filled.first || start - group >= filled.end)
        return;
    for (int phase = 0; phase < bins_per_pixel; phase++) {
        GLOBAL float *out = sorted + phase * stride + column;
        for (int lane = 0; lane < WIDTH; lane++) {
            const int bin = start + phase + lane * bins_per_pixel;
            out[lane] = is_inside || (bin >= 0 && bin < bins) ? line[bin] : 0.0f;
        }
    }
}

/* Returns the first tap that meets filled bins, for WIDTH pixels of which the first begins at
 * `start`. All taps before it, and those from end_of_taps on, would add zeros. */
FUNCTION int first_tap_of(int start, struct filled_span filled, int bins_per_pixel)
{
    const int outside = filled.first - start - (WIDTH - 1) * bins_per_pixel;
    return outside > 0 ? outside : 0;
}

FUNCTION int end_of_taps(int start, struct filled_span filled, int taps)
{
    return filled.end - start < taps ? filled.end - start : taps;
}

/* Compresses the WIDTH pixels from `column` on in range. Pixel j is the sum over taps of line[j *
 * bins_per_pixel + first + tap] * pulse[tap], from the line's sorted bins. Lanes are pixels, so
 * that each sum keeps its order whatever a compiler makes of the loop. `out` must have room for
 * whole groups of WIDTH. */
FUNCTION void compress_range_of(GLOBAL const float *sorted, int stride, struct filled_span filled,
                                int first, int bins_per_pixel, GLOBAL const float *pulse, int taps,
                                int column, GLOBAL float *out)
{
    const int start = column * bins_per_pixel + first;
    vfloat sum = SPLAT(0.0f);
    const int end = end_of_taps(start, filled, taps);
    int tap = first_tap_of(start, filled, bins_per_pixel);
    int phase = tap % bins_per_pixel;
    GLOBAL const float *bins = sorted + column + tap / bins_per_pixel;
    for (; tap < end; tap++) {
        sum += LOAD_VFLOAT(bins + phase * stride) * pulse[tap];
        phase = phase + 1 < bins_per_pixel ? phase + 1 : 0;
        bins += phase == 0;
    }
    STORE_VFLOAT(sum, out + column);
}

/* Compresses as compress_range_of does, with a complex pulse, both parts of the line at once. */
FUNCTION void compress_complex_of(GLOBAL const float *sorted_real,
                                  GLOBAL const float *sorted_imaginary, int stride,
                                  struct filled_span filled, int first, int bins_per_pixel,
                                  GLOBAL const float *pulse_real,
                                  GLOBAL const float *pulse_imaginary, int taps, int column,
                                  GLOBAL float *out_real, GLOBAL float *out_imaginary)
{
    const int start = column * bins_per_pixel + first;
    vfloat sum_real = SPLAT(0.0f);
    vfloat sum_imaginary = SPLAT(0.0f);
    const int end = end_of_taps(start, filled, taps);
    for (int tap = first_tap_of(start, filled, bins_per_pixel); tap < end; tap++) {
        const int at = tap % bins_per_pixel * stride + column + tap / bins_per_pixel;
        const vfloat a = LOAD_VFLOAT(sorted_real + at);
        const vfloat b = LOAD_VFLOAT(sorted_imaginary + at);
        sum_real += a * pulse_real[tap] - b * pulse_imaginary[tap];
        sum_imaginary += a * pulse_imaginary[tap] + b * pulse_real[tap];
    }
    STORE_VFLOAT(sum_real, out_real + column);
    STORE_VFLOAT(sum_imaginary, out_imaginary + column);
}

/* The strips from which a row takes its aspects. */
struct aspects {
    int first_strip, end_strip; /* strips of the lines, on the track's numbering: first...end - 1 */
    int strips_per_row;
    int reach; /* the response is kept within +-reach strips; 2 reach + 1 taps */
};

/* Returns whether WIDTH columns of a line may hold anything but zeros. */
FUNCTION int is_filled_at(struct filled_span columns, int column)
{
    return columns.first < column + WIDTH && columns.end > column;
}

#define FORM_ROWS 8 /* rows that a work-item forms, so that a line is read once for all of them */

/* Applies the cross-range response to FORM_ROWS x WIDTH pixels. Row n is the sum over strips q of
 * lines[q] * response[n * strips_per_row - q + reach], except for columns that a strip leaves
 * empty. Before and behind the response lie (FORM_ROWS - 1) * strips_per_row zeros. Planes are
 * rows_or_strips x stride. */
FUNCTION void combine_aspects_of(struct aspects aspects, GLOBAL const float *lines,
                                 GLOBAL const struct filled_span *filled, int stride,
                                 GLOBAL const float *response, int first_row, int rows, int column,
                                 GLOBAL float *out)
{
    vfloat sum[FORM_ROWS];
    for (int r = 0; r < FORM_ROWS; r++)
        sum[r] = SPLAT(0.0f);
    int low = first_row * aspects.strips_per_row - aspects.reach;
    int high = (first_row + FORM_ROWS - 1) * aspects.strips_per_row + aspects.reach + 1;
    low = low < aspects.first_strip ? aspects.first_strip : low;
    high = high > aspects.end_strip ? aspects.end_strip : high;
    for (int strip = low; strip < high; strip++) {
        if (!is_filled_at(filled[strip - aspects.first_strip], column))
            continue;
        const vfloat a =
            LOAD_VFLOAT(lines + (LONG_INDEX)(strip - aspects.first_strip) * stride + column);
        GLOBAL const float *tap =
            response + (first_row + FORM_ROWS - 1) * aspects.strips_per_row - strip + aspects.reach;
        UNROLLED
        for (int r = 0; r < FORM_ROWS; r++)
            sum[r] += a * tap[r * aspects.strips_per_row];
    }
    for (int r = 0; r < FORM_ROWS && first_row + r < rows; r++)
        STORE_VFLOAT(sum[r], out + (LONG_INDEX)(first_row + r) * stride + column);
}

/* The responses of a set of rows and blocks of columns. Each has the taps of struct aspects. */
struct response_set {
    int first_row;         /* first row of the set */
    int row_step;          /* floats from a row's taps to the next row's; 0: all rows share them */
    int columns_per_block; /* a multiple of WIDTH */
    int block_step;        /* floats from a block's taps to the next block's */
};

/* Combines as combine_aspects_of does, with a complex response that may differ from row to row and
 * from block to block. */
FUNCTION void combine_varied_of(struct aspects aspects, struct response_set set,
                                GLOBAL const float *lines_real, GLOBAL const float *lines_imaginary,
                                GLOBAL const struct filled_span *filled, int stride,
                                GLOBAL const float *response_real,
                                GLOBAL const float *response_imaginary, int first_row, int rows,
                                int column, GLOBAL float *out_real, GLOBAL float *out_imaginary)
{
    const int taps = 2 * aspects.reach + 1;
    const LONG_INDEX block = (LONG_INDEX)(column / set.columns_per_block) * set.block_step;
    for (int row = first_row; row < first_row + FORM_ROWS && row < rows; row++) {
        const LONG_INDEX first_tap = (LONG_INDEX)(row - set.first_row) * set.row_step + block;
        const int last = row * aspects.strips_per_row + aspects.reach; /* strip of tap 0 */
        int low = last - taps + 1;
        int high = last + 1;
        low = low < aspects.first_strip ? aspects.first_strip : low;
        high = high > aspects.end_strip ? aspects.end_strip : high;
        vfloat sum_real = SPLAT(0.0f);
        vfloat sum_imaginary = SPLAT(0.0f);
        for (int strip = low; strip < high; strip++) {
            if (!is_filled_at(filled[strip - aspects.first_strip], column))
                continue;
            const LONG_INDEX at = (LONG_INDEX)(strip - aspects.first_strip) * stride + column;
            const vfloat a = LOAD_VFLOAT(lines_real + at);
            const vfloat b = LOAD_VFLOAT(lines_imaginary + at);
            const float w = response_real[first_tap + last - strip];
            const float v = response_imaginary[first_tap + last - strip];
            sum_real += a * w - b * v;
            sum_imaginary += a * v + b * w;
        }
        const LONG_INDEX at = (LONG_INDEX)row * stride + column;
        STORE_VFLOAT(sum_real, out_real + at);
        STORE_VFLOAT(sum_imaginary, out_imaginary + at);
    }
}

#endif
