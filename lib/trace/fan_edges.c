/* A patch's rays by the bins in which they meet level seabed. A bin has the same rays wherever the
 * patch, or a window of it, begins and ends. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "trace/fan.h"

#define LANES_MOST 16
#define ROUNDING   1e-6

/* The state while rays are laid. */
struct laying {
    struct fan_edges *edges;
    const struct tracer *tracer;
    double central; /* grazing angle of the central direction, rad */
    double grazing; /* grazing angle of the last edge, rad */
    double per_bin; /* rays of a bin, scaled; below 1 bins share one */
    double finest;  /* step that objects need, rad */
};

/* Appends rays of equal steps from the last edge to a flatter grazing angle, rad. */
static sonject_status add_rays(struct laying *laying, double grazing, double rays)
{
    struct fan_edges *edges = laying->edges;
    struct report *report = laying->tracer->report;
    const double step = (laying->grazing - grazing) / rays;
    const double all = (double)edges->count + rays;
    if (!(all < FAN_RAYS_MAX))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the patch needs %.3g rays a ping: use a smaller patch or fewer rays",
                              all);
    const size_t needed = (size_t)all + LANES_MOST;
    if (needed > edges->capacity) {
        float *grown = realloc(edges->elevations, 2 * needed * sizeof *grown);
        CHECK_MEMORY(report, grown, "the rays");
        edges->elevations = grown;
        edges->capacity = 2 * needed;
    }
    for (double ray = 1.0; ray <= rays; ray += 1.0)
        edges->elevations[edges->count++] =
            (float)(laying->central - (laying->grazing - step * ray));
    edges->widest = fmax(edges->widest, step);
    laying->grazing = grazing;
    return SONJECT_OK;
}

/* Appends rays of at most `step` rad up to a grazing angle; none where the angle is no flatter. */
static sonject_status add_steps(struct laying *laying, double grazing, double step)
{
    return grazing < laying->grazing
               ? add_rays(laying, grazing, ceil((laying->grazing - grazing) / step))
               : SONJECT_OK;
}

/* Appends the rays of the bins up to a processor range, m. Bins in the water column have none. */
static sonject_status add_bins(struct laying *laying, double bin_m, double range_m)
{
    const struct patch_view *view = &laying->tracer->view;
    const double grazing = view_grazing(view, range_m);
    const double across = bin_m / (range_m / view->range_ratio) / fmax(laying->per_bin, 1.0);
    const double steps = (laying->grazing - grazing) / fmin(across, laying->finest);
    if (!(grazing < laying->grazing))
        return SONJECT_OK;
    return add_rays(laying, grazing, ceil(fmax(laying->per_bin, steps) - ROUNDING));
}

sonject_status fan_edges_init(struct fan_edges *edges, struct fan_record *fan,
                              const struct tracer *tracer, const struct line_grid *grid,
                              double nearest_m, double rays_per_bin)
{
    const struct patch_view *view = &tracer->view;
    const double per_pixel = grid->bins_per_pixel;
    const double offset = (double)view->first_column * per_pixel; /* bin numbers are the patch's */
    const double end = grid->bins.first + grid->bins.count + 1.0; /* the next shares with these */
    const double nearest = fmax(nearest_m, view_bottom_range(view));
    struct laying laying = {.edges = edges, .tracer = tracer};
    double origin[3];
    patch_fan_origin(origin, view);
    laying.central = ray_path_grazing(&view->water, origin[1], 0.0);
    laying.per_bin = rays_per_bin * tracer->scene->injection.ray_scale;
    laying.finest = fan_step_to_objects(tracer, (double)fan->strip_width);
    const double group = laying.per_bin < 1.0 ? floor(1.0 / laying.per_bin) : 1.0;
    const double bin_m = group * view->column_spacing_m / per_pixel / view->range_ratio;
    const double first =
        floor((floor(view_column_of_range(view, nearest) * per_pixel + 0.5) + offset) / group);
    const double near_range =
        view_processor_range(view, (first * group - offset - 0.5) / per_pixel);
    struct grazing_angles angles = {view_grazing(view, fmax(nearest, near_range)), 0.0};
    const double steepest = tracer->relief ? grazing_over_relief(tracer, angles).near : angles.near;
    memset(edges, 0, sizeof *edges);
    laying.grazing = steepest;
    CHECK(add_rays(&laying, steepest, 1.0));
    CHECK(add_steps(&laying, angles.near,
                    fan_elevation_step(tracer, grid, angles.near, rays_per_bin)));
    for (double bin = first * group - offset; bin < end; bin += group)
        CHECK(
            add_bins(&laying, bin_m, view_processor_range(view, (bin + group - 0.5) / per_pixel)));
    angles.far = laying.grazing;
    const double flattest = tracer->relief ? grazing_over_relief(tracer, angles).far : angles.far;
    const double highest = fan_highest_elevation(tracer, laying.central, laying.central - flattest);
    CHECK(
        add_steps(&laying, laying.central - highest,
                  fmin(fan_elevation_step(tracer, grid, angles.far, rays_per_bin), laying.finest)));
    fan->rays = (uint32_t)(edges->count - 1);
    fan->first_ray = (uint32_t)(int64_t)(first * fmax(ceil(laying.per_bin - ROUNDING), 1.0));
    fan->elevation_step = (float)edges->widest;
    for (int lane = 0; lane < LANES_MOST; lane++, edges->count++)
        edges->elevations[edges->count] = edges->elevations[edges->count - 1];
    return SONJECT_OK;
}
