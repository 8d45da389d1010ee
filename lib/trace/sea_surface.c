#include "trace/sea_surface.h"

#include <math.h>

#include "scene/surface_material.h"
#include "trace/sources.h"

/* A mirror alone lengthens chains of two interactions to three; what it adds to a single one is the
 * pairs of sources'. */
static bool adds_to_chains(const struct scene *scene)
{
    const sonject_material_params material = surface_material(&scene->surface);
    const uint32_t interactions = scene->injection.interactions;
    return interactions > 1 &&
           (material_is_rough(&material) || (material_is_smooth(&material) && interactions > 2));
}

static double earliest_half_path(const struct tracer *tracer)
{
    const double sonar = tracer->view.altitude_m;
    const double image = 2.0 * tracer->scene->surface.water_depth_m - sonar;
    double earliest = INFINITY;
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct placement *placement = &tracer->placements[i];
        const double *centre = placement->centre;
        const double by_centre =
            0.5 * (hypot(centre[1], sonar - centre[2]) + hypot(centre[1], image - centre[2]));
        earliest = fmin(earliest, by_centre - placement->bounding_radius_m);
    }
    return earliest;
}

bool sea_surface_is_in_chains(const struct tracer *tracer, const struct line_grid *grid)
{
    const struct patch_view *view = &tracer->view;
    const struct water *water = view->water.water;
    const double depth = tracer->scene->surface.water_depth_m;
    if (!(depth > 0.0) || !adds_to_chains(tracer->scene) ||
        (water->count > 1 && water->layers[1].bottom_m < depth))
        return false;
    const double side = tracer->scene->sonar.transducer_side_m;
    return (earliest_half_path(tracer) - side) * view->range_ratio < line_grid_far_end(grid, view);
}
