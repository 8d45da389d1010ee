#include "image/plot_cells.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"

#define LONGEST_SHAPE 5.0 /* length to width: longer images are drawn wider than they are */

/* The energies of all float amplitudes lie between these. */
#define LOWEST_DB      -900.0
#define HIGHEST_DB     780.0
#define BINS_PER_DB    100
#define PERCENTILE_LOW 0.03
#define PERCENTILE_TOP 0.998

/* The scale that draws `pixels` pixels about `length` picture pixels long. */
static struct plot_scale scale_of(uint64_t pixels, double length)
{
    struct plot_scale scale = {pixels, 1, 1, 0};
    const double size = length / (double)pixels;
    if (size >= 1.0)
        scale.up = (uint32_t)floor(size + 0.5);
    else
        scale.down = (uint32_t)floor(fmin(1.0 / size, 4e9) + 0.5);
    scale.cells = (uint32_t)((pixels - 1) / scale.down + 1);
    return scale;
}

void plot_scales(const struct plot_frame *frame, double target, struct plot_scale *along_track,
                 struct plot_scale *range)
{
    const double ratio = frame->row_spacing_m / frame->column_spacing_m;
    const double row_size = isfinite(ratio) && ratio > 0.0 ? ratio : 1.0;
    const double height = row_size * (double)frame->rows;
    const double width = (double)frame->columns;
    const double longest = fmax(height, width);
    const double shortest = longest / LONGEST_SHAPE;
    *along_track = scale_of(frame->rows, fmax(height, shortest) / longest * target);
    *range = scale_of(frame->columns, fmax(width, shortest) / longest * target);
}

/* Sums of a row of cells, and how many pixels each holds. */
struct cell_sums {
    double *sum;
    uint64_t *count;
};

static void add_row(const struct cell_sums *sums, const float *pixels,
                    const struct plot_scale *range, bool is_difference)
{
    for (size_t cell = 0; cell < range->cells; cell++) {
        const size_t first = cell * range->down;
        const size_t left = (size_t)range->pixels - first;
        const size_t end = first + (left < range->down ? left : range->down);
        for (size_t i = first; i < end; i++) {
            const double value = (double)pixels[i];
            if (isnan(value))
                continue;
            sums->sum[cell] += is_difference ? value : value * value;
            sums->count[cell]++;
        }
    }
}

static void finish_row(const struct cell_sums *sums, uint32_t cells, bool is_difference,
                       float *values)
{
    for (size_t cell = 0; cell < cells; cell++) {
        const double mean = sums->sum[cell] / (double)sums->count[cell]; /* NaN if there is none */
        values[cell] = (float)(is_difference ? mean : 10.0 * log10(mean));
        sums->sum[cell] = 0.0;
        sums->count[cell] = 0;
    }
}

sonject_status plot_cells(struct report *report, const struct plot_panel *panel,
                          const struct plot_scale *along_track, const struct plot_scale *range,
                          float *values)
{
    const struct cell_sums sums = {allocate_array(range->cells, sizeof(double)),
                                   allocate_array(range->cells, sizeof(uint64_t))};
    sonject_status status = SONJECT_OK;
    if (sums.sum && sums.count) {
        for (uint64_t row = 0; row < along_track->pixels; row++) {
            add_row(&sums, panel->amplitude + row * range->pixels, range, panel->is_difference);
            if ((row + 1) % along_track->down == 0 || row + 1 == along_track->pixels)
                finish_row(&sums, range->cells, panel->is_difference,
                           values + row / along_track->down * range->cells);
        }
    } else {
        status = report_out_of_memory(report, "a picture");
    }
    free(sums.sum);
    free(sums.count);
    return status;
}

/* The middle of the bin below whose end at least `share` of all values lie. */
static double percentile(const uint32_t *bins, uint64_t total, double share)
{
    uint64_t passed = 0;
    size_t bin = 0;
    while ((double)(passed += bins[bin]) < share * (double)total)
        bin++;
    return LOWEST_DB + ((double)bin + 0.5) / BINS_PER_DB;
}

sonject_status plot_limits(struct report *report, const float *decibels, size_t count,
                           double *minimum, double *maximum)
{
    const size_t bin_count = (size_t)(HIGHEST_DB - LOWEST_DB) * BINS_PER_DB;
    uint32_t *bins = allocate_array(bin_count, sizeof *bins);
    CHECK_MEMORY(report, bins, "a picture");
    uint64_t total = 0;
    for (size_t i = 0; i < count; i++) {
        const double value = (double)decibels[i];
        if (value > LOWEST_DB && value < HIGHEST_DB) {
            bins[(size_t)((value - LOWEST_DB) * BINS_PER_DB)]++;
            total++;
        }
    }
    if (total > 0) {
        *minimum = percentile(bins, total, PERCENTILE_LOW);
        *maximum = percentile(bins, total, PERCENTILE_TOP);
    }
    free(bins);
    if (total == 0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "nothing to draw: no pixel of the image is above 0");
    if (*maximum - *minimum < 1.0) {
        const double middle = 0.5 * (*minimum + *maximum);
        *minimum = middle - 10.0;
        *maximum = middle + 10.0;
    }
    return SONJECT_OK;
}
