#include "trace/patch_fan.h"

#include <math.h>
#include <string.h>

#include "trace/chain_reach.h"
#include "trace/object_rays.h"
#include "trace/sources.h"

#define PI           3.14159265358979323846
#define RAYS_MAX     67108864.0
#define OBJECT_RAYS  16.0 /* at least, on a rough object: its energy is then known to 1 dB */
#define SURROUNDINGS 18.0 /* in bounding radii of an object */

void patch_fan_origin(double origin[3], const struct patch_view *view)
{
    const double first = fmax(0.0, view_column_of_range(view, view_bottom_range(view)));
    const double middle = view_apparent_range(view, 0.5 * (first + (double)(view->columns - 1)));
    origin[0] = view_x_of_row(view, 0.5 * (double)(view->rows - 1));
    origin[1] = view_ground_range(view, middle);
    origin[2] = 0.0;
}

/* Seabed and heights that rays of the patch's frame come to. */
struct region {
    double near, far;   /* ground range, m */
    double bottom, top; /* heights, m */
};

/* A little further than chains reach, if there are any. */
static struct chain_reach surroundings_of(const struct tracer *tracer,
                                          const struct placement *placement)
{
    const double least = SURROUNDINGS * placement->bounding_radius_m;
    struct chain_reach reach = {least, least};
    if (tracer->scene->injection.interactions < 2)
        return reach;
    reach = chain_reach_of(tracer, placement);
    reach.around_m = fmax(least, 1.05 * reach.around_m);
    reach.towards_sonar_m = fmax(least, 1.05 * reach.towards_sonar_m);
    return reach;
}

static struct region region_of_patch(const struct tracer *tracer, const struct line_grid *grid)
{
    static const double upward[3] = {0.0, 0.0, 1.0};
    const struct patch_view *view = &tracer->view;
    struct region region;
    region.near = view_ground_range(view, line_grid_near_end(grid, view));
    region.far = view_ground_range(view, line_grid_far_end(grid, view));
    region.bottom = tracer_lowest_seabed(tracer);
    region.top = tracer_highest_seabed(tracer);
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct placement *placement = &tracer->placements[i];
        const struct chain_reach reach = surroundings_of(tracer, placement);
        region.near = fmin(region.near, placement->centre[1] - reach.towards_sonar_m);
        region.far = fmax(region.far, placement->centre[1] + reach.around_m);
        region.top =
            fmax(region.top, placement->centre[2] + placement_half_extent(placement, upward));
    }
    return region;
}

sonject_status patch_rays_init(struct ray_table *rays, struct ray_table_record *record,
                               const struct tracer *tracer, const struct line_grid *grid)
{
    const struct water_way *way = &tracer->view.water;
    const struct region region = region_of_patch(tracer, grid);
    /* a little farther: what is sought beside the region; much farther there may be no ray */
    const double points[4][2] = {{region.near, region.bottom},
                                 {region.near, region.top},
                                 {region.far, region.bottom},
                                 {1.05 * region.far, region.top}};
    double origin[3];
    patch_fan_origin(origin, &tracer->view);
    memset(rays, 0, sizeof *rays);
    return ray_table_add(
        rays, tracer->report, way, origin[1], origin[2],
        elevations_of_points(way, water_way_grazing(way, origin[1], origin[2]), points, 4), record);
}

/* Elevation of the highest object over the central direction. */
static double highest_elevation(const struct tracer *tracer, double central_grazing, double lowest)
{
    const struct patch_view *view = &tracer->view;
    double highest = lowest;
    for (uint32_t i = 0; i < tracer->part_count; i++)
        highest = fmax(highest, central_grazing - placement_grazing(&tracer->placements[i], view) +
                                    elevations_of_object(tracer, i, &view->water).highest);
    return highest;
}

double fan_elevation_step(const struct tracer *tracer, const struct line_grid *grid,
                          double grazing_rad, double rays_per_bin)
{
    const struct patch_view *view = &tracer->view;
    const double bin = view->column_spacing_m / grid->bins_per_pixel / view->range_ratio;
    const double radius = water_way_ray(&view->water, grazing_rad, 0.0).wavefront_m;
    return fmin(tan(grazing_rad), 1.0) * bin / radius /
           (rays_per_bin * tracer->scene->injection.ray_scale);
}

/* The step at which the smallest rough object, a sphere as large as that, is met by OBJECT_RAYS. */
static double step_to_objects(const struct tracer *tracer, double strip_m)
{
    double step = INFINITY;
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct placement *placement = &tracer->placements[i];
        const double size = tracer->objects[placement->object].size_m;
        const double grazing = placement_grazing(placement, &tracer->view);
        const double radius =
            water_way_ray(&tracer->view.water, grazing, placement->centre[2]).wavefront_m;
        if (material_is_rough(placement->material))
            step = fmin(step, 0.25 * PI * size * size / (OBJECT_RAYS * strip_m * radius));
    }
    return step / tracer->scene->injection.ray_scale;
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

struct grazing_angles grazing_over_relief(const struct tracer *tracer, struct grazing_angles plane)
{
    const struct relief *relief = tracer->relief;
    const struct water_way *way = &tracer->view.water;
    const double end = relief->first_y_m + (relief->columns - 1) * relief->column_step_m;
    const struct grazing_angles angles = {
        fmax(plane.near, water_way_grazing(way, relief->first_y_m, relief->lowest_m)),
        fmin(plane.far, water_way_grazing(way, end, relief->highest_m))};
    return angles;
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
    const double central = water_way_grazing(&view->water, origin[1], 0.0);
    const double near = view_grazing(view, line_grid_near_end(grid, view));
    const double far = view_grazing(view, line_grid_far_end(grid, view));
    struct grazing_angles edges = {near, far};
    if (tracer->relief)
        edges = grazing_over_relief(tracer, edges);
    return fan_lay_rays(fan, tracer->report, central - edges.near,
                        highest_elevation(tracer, central, central - edges.far),
                        fmin(fan_elevation_step(tracer, grid, far, rays_per_bin),
                             step_to_objects(tracer, (double)fan->strip_width)));
}
