#include "scene/line_grid.h"

#include <math.h>

#include "scene/cross_range.h"

#define BINS_PER_RESOLUTION 8    /* sharing between bins then errs by 0.05 dB at most */
#define ROUNDING            1e-9 /* 2.5 cm over 2.5 cm is one strip, not two */

static int32_t bins_of(const struct patch_view *view, double length_m, uint32_t bins_per_pixel)
{
    return (int32_t)ceil(length_m * bins_per_pixel / view->column_spacing_m);
}

int32_t pulse_reach_bins(const struct patch_view *view, const struct point_response *response,
                         uint32_t bins_per_pixel)
{
    return bins_of(view, response->pulse_reach_m, bins_per_pixel);
}

int32_t pulse_tail_bins(const struct patch_view *view, const struct point_response *response,
                        uint32_t bins_per_pixel)
{
    return bins_of(view, response->pulse_tail_m, bins_per_pixel);
}

void line_grid_for_patch(struct line_grid *grid, const struct patch_view *view,
                         const struct point_response *response)
{
    const double resolution = 2.0 * sqrt(log(2.0)) * response->range_deviation_m;
    grid->strips_per_row = (uint32_t)ceil(view->row_spacing_m / response->strip_m - ROUNDING);
    grid->bins_per_pixel =
        (uint32_t)ceil(BINS_PER_RESOLUTION * view->column_spacing_m / resolution - ROUNDING);
    const double farthest = view_processor_range(view, (double)(view->columns - 1));
    const double strip = view->row_spacing_m / grid->strips_per_row;
    const int32_t strip_margin =
        (int32_t)ceil(cross_range_energy_reach(response, farthest, MARGIN_ENERGY_SHARE) / strip);
    const int32_t bin_margin = bins_of(view, response->pulse_margin_m, grid->bins_per_pixel);
    /* nothing returns from before range 0 */
    const int32_t bins_before = (int32_t)fmin(
        bin_margin, view->first_range_m * grid->bins_per_pixel / view->column_spacing_m);
    grid->strips.first = -strip_margin;
    grid->strips.count = (int32_t)(view->rows * grid->strips_per_row) + 2 * strip_margin;
    grid->bins.first = -bins_before;
    grid->bins.count =
        (int32_t)((view->columns - 1) * grid->bins_per_pixel) + 1 + bins_before + bin_margin;
}

double line_grid_shortest_deviation(const struct line_grid *grid, double column_spacing_m)
{
    return BINS_PER_RESOLUTION * column_spacing_m /
           (2.0 * sqrt(log(2.0)) * (double)grid->bins_per_pixel);
}

double line_grid_near_end(const struct line_grid *grid, const struct patch_view *view)
{
    return view_processor_range(view, (grid->bins.first - 1.0) / grid->bins_per_pixel);
}

double line_grid_far_end(const struct line_grid *grid, const struct patch_view *view)
{
    const double end = grid->bins.first + grid->bins.count;
    return view_processor_range(view, end / grid->bins_per_pixel);
}

size_t line_grid_cells(const struct line_grid *grid)
{
    return (size_t)grid->strips.count * (size_t)grid->bins.count;
}
