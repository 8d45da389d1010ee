#include "trace/patch_fan.h"

#include <math.h>

#define PI       3.14159265358979323846
#define RAYS_MAX 67108864.0

void patch_fan_origin(double origin[3], const struct patch_view *view)
{
    const double middle = view_apparent_range(view, 0.5 * (double)(view->columns - 1));
    origin[0] = view_x_of_row(view, 0.5 * (double)(view->rows - 1));
    origin[1] = view_ground_range(view, middle);
    origin[2] = 0.0;
}

double seabed_depression(const struct patch_view *view, double range_m)
{
    const double sine = view->altitude_m / range_m;
    return sine < 1.0 ? asin(sine) : 0.5 * PI;
}

/* Elevation of the highest object over the central direction. */
static double highest_elevation(const struct tracer *tracer, double central_depression,
                                double lowest)
{
    double highest = lowest;
    for (uint32_t i = 0; i < tracer->scene->object_count; i++) {
        const struct placement *placement = &tracer->placements[i];
        const double depression =
            atan2(tracer->view.altitude_m - placement->centre[2], placement->centre[1]);
        const double across[3] = {0.0, sin(depression), cos(depression)};
        const double extent =
            placement_half_extent(placement, tracer->scene->objects[i].shape, across);
        const double range = placement_range(placement, &tracer->view);
        const double top = central_depression - depression + asin(fmin(1.0, 1.05 * extent / range));
        highest = fmax(highest, top);
    }
    return highest;
}

/* True range at a bin coordinate. */
static double range_of_bin(const struct tracer *tracer, const struct line_grid *grid, double bin)
{
    return view_apparent_range(&tracer->view, bin / grid->bins_per_pixel) /
           tracer->view.range_ratio;
}

double fan_elevation_step(const struct tracer *tracer, const struct line_grid *grid, double range_m,
                          double rays_per_bin)
{
    const struct patch_view *view = &tracer->view;
    const double bin = view->column_spacing_m / grid->bins_per_pixel / view->range_ratio;
    const double step_for_seabed = tan(seabed_depression(view, range_m)) * bin / range_m;
    const double step_for_objects = bin / range_m;
    return fmin(step_for_seabed, step_for_objects) /
           (rays_per_bin * tracer->scene->injection.ray_scale);
}

sonject_status fan_lay_rays(struct fan_record *fan, struct report *report, double lowest,
                            double highest, double step)
{
    const double rays = ceil((highest - lowest) / step);
    if (!(rays < RAYS_MAX))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the patch needs %.3g rays a ping: use a smaller patch or fewer rays",
                              rays);
    fan->rays = (uint32_t)rays;
    fan->first_elevation = (float)lowest;
    fan->elevation_step = (float)((highest - lowest) / rays);
    return SONJECT_OK;
}

sonject_status patch_fan_init(struct fan_record *fan, struct tracer *tracer,
                              const struct line_grid *grid, bool has_map, double rays_per_bin)
{
    const struct patch_view *view = &tracer->view;
    double origin[3];
    patch_fan_origin(origin, view);
    fan_record_init(fan, tracer, origin, grid);
    fan->map_rows = has_map ? (int32_t)view->rows : 0;
    fan->map_columns = has_map ? (int32_t)view->columns : 0;
    const double central_depression = atan2(view->altitude_m, origin[1]);
    const double near = range_of_bin(tracer, grid, grid->bins.first - 0.5);
    const double far = range_of_bin(tracer, grid, grid->bins.first + grid->bins.count - 0.5);
    const double lowest = central_depression - seabed_depression(view, near);
    const double highest = highest_elevation(tracer, central_depression,
                                             central_depression - seabed_depression(view, far));
    return fan_lay_rays(fan, tracer->report, lowest, highest,
                        fan_elevation_step(tracer, grid, far, rays_per_bin));
}
