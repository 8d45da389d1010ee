#include "scene/line_grid.h"

#include <math.h>

#define BINS_PER_RESOLUTION 4     /* deviates are drawn for cells of a quarter of the resolution */
#define MARGIN_ENERGY_SHARE 0.005 /* of |W|^2 that lies beyond the margin */
#define PULSE_REACH         5.0   /* deviations of the envelope */
#define ROUNDING            1e-9  /* 2.5 cm over 2.5 cm is one strip, not two */

int32_t pulse_reach_bins(const struct patch_view *view, const struct point_response *response,
                         uint32_t bins_per_pixel)
{
    return (int32_t)ceil(PULSE_REACH * response->range_deviation_m * bins_per_pixel /
                         view->column_spacing_m);
}

void line_grid_for_patch(struct line_grid *grid, const struct patch_view *view,
                         const struct point_response *response)
{
    const double resolution = 2.0 * sqrt(log(2.0)) * response->range_deviation_m;
    grid->strips_per_row = (uint32_t)ceil(view->row_spacing_m / response->resolution_m - ROUNDING);
    grid->bins_per_pixel =
        (uint32_t)ceil(BINS_PER_RESOLUTION * view->column_spacing_m / resolution - ROUNDING);
    const double strip = view->row_spacing_m / grid->strips_per_row;
    const int32_t strip_margin =
        (int32_t)ceil(along_track_energy_reach(response, MARGIN_ENERGY_SHARE) / strip);
    const int32_t bin_margin = pulse_reach_bins(view, response, grid->bins_per_pixel);
    grid->strips.first = -strip_margin;
    grid->strips.count = (int32_t)(view->rows * grid->strips_per_row) + 2 * strip_margin;
    grid->bins.first = -bin_margin;
    grid->bins.count = (int32_t)((view->columns - 1) * grid->bins_per_pixel) + 1 + 2 * bin_margin;
}

double line_grid_shortest_deviation(const struct line_grid *grid, double column_spacing_m)
{
    return BINS_PER_RESOLUTION * column_spacing_m /
           (2.0 * sqrt(log(2.0)) * (double)grid->bins_per_pixel);
}

size_t line_grid_cells(const struct line_grid *grid)
{
    return (size_t)grid->strips.count * (size_t)grid->bins.count;
}
