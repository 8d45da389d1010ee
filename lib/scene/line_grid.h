/* The fine grid on which echoes are collected before image formation. Strips divide rows: strip q
 * is part of row floor(q / strips_per_row); bins divide pixels: the middle of bin b is at column
 * b / bins_per_pixel. Numbers below 0 and beyond the patch are its margins. */
#ifndef SONJECT_SCENE_LINE_GRID_H
#define SONJECT_SCENE_LINE_GRID_H

#include <stddef.h>
#include <stdint.h>

#include "scene/patch_view.h"
#include "scene/point_response.h"

struct span {
    int32_t first, count;
};

struct line_grid {
    uint32_t strips_per_row, bins_per_pixel;
    struct span strips, bins;
};

/* The grid for energies and speckle: cells of at most the along-track resolution by an eighth of
 * the range resolution, with margins that hold all but 0.5 % of the energies of cross-range
 * response and pulse, and end at range 0. */
void line_grid_for_patch(struct line_grid *grid, const struct patch_view *view,
                         const struct point_response *response);

/* Bins on each side of a pixel that hold all but 0.1 % of the pulse's energy, and those that glints
 * are spread over: to where its side lobes are below -60 dB. A Gaussian's are both 5 deviations
 * (-108 dB). */
int32_t pulse_reach_bins(const struct patch_view *view, const struct point_response *response,
                         uint32_t bins_per_pixel);

int32_t pulse_tail_bins(const struct patch_view *view, const struct point_response *response,
                        uint32_t bins_per_pixel);

/* Standard deviation in m of the shortest pulse that the bins of line_grid_for_patch are fine
 * enough for. */
double line_grid_shortest_deviation(const struct line_grid *grid, double column_spacing_m);

/* The processor ranges, m, between which echoes share with the grid's bins: a bin beyond the
 * middles of its outermost ones. */
double line_grid_near_end(const struct line_grid *grid, const struct patch_view *view);
double line_grid_far_end(const struct line_grid *grid, const struct patch_view *view);

/* strips.count * bins.count */
size_t line_grid_cells(const struct line_grid *grid);

#endif
