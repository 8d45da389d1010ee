/* What a plot shows of an image: its pixels averaged or enlarged to the size of a panel, in dB. */
#ifndef SONJECT_IMAGE_PLOT_CELLS_H
#define SONJECT_IMAGE_PLOT_CELLS_H

#include "image/plot.h"

/* One axis of a panel: `down` image pixels are averaged to a cell, which is drawn `up` pixels wide;
 * one of the two is 1. */
struct plot_scale {
    uint64_t pixels;
    uint32_t up, down;
    uint32_t cells;
};

/* Scales that make the longer side of a panel about `target` pixels long and keep distances on
 * both axes in proportion, as far as whole factors can; images more than five times as long as wide
 * are drawn wider than they are. */
void plot_scales(const struct plot_frame *frame, double target, struct plot_scale *along_track,
                 struct plot_scale *range);

/* Mean energies in dB (-infinity where there is none) or mean differences of each cell. Pixels that
 * are no numbers count for nothing; a cell of nothing else is NaN. values: cells of the two
 * scales. Errors: MEMORY. */
sonject_status plot_cells(struct report *report, const struct plot_panel *panel,
                          const struct plot_scale *along_track, const struct plot_scale *range,
                          float *values);

/* The 3rd and 99.8th percentile of the finite values, at least 1 dB apart. Errors: INPUT (there are
 * none), MEMORY. */
sonject_status plot_limits(struct report *report, const float *decibels, size_t count,
                           double *minimum, double *maximum);

#endif
