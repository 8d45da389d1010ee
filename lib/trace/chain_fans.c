#include "trace/chain_fans.h"

#include <math.h>

#include "scene/surface_material.h"
#include "trace/fan.h"
#include "trace/image_sources.h"

#define PI 3.14159265358979323846

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

/* In sizes of the part, or in its heights if that is more. */
#define REACH_AROUND 16.0

/* In ways from below the part to the seabed's mirror point, which lies nearer to the sonar the
 * flatter sound comes: what goes by there comes first. */
#define REACH_TO_MIRROR 6.5

/* Half the sum of the heights of the top and of the lowest point that is not buried. */
static double mean_height(const struct tracer *tracer, const struct placement *placement)
{
    static const double upward[3] = {0.0, 0.0, 1.0};
    const double half_extent = placement_half_extent(placement, upward);
    const double height = placement->centre[2] - tracer_lowest_seabed(tracer);
    return 0.5 * (fmax(height + half_extent, 0.0) + fmax(height - half_extent, 0.0));
}

/* What is further from the part is heard after the patch's last range, r_B + d + r over 2, even
 * straight below the sonar; a little more, for the point response. */
static double heard_reach(const struct tracer *tracer, const struct placement *placement)
{
    const struct patch_view *view = &tracer->view;
    const double last = 1.02 * view_processor_range(view, (double)view->columns);
    return 2.0 * last - placement_range(placement, view) - view->altitude_m;
}

struct chain_reach chain_reach_of(const struct tracer *tracer, const struct placement *placement)
{
    const double radius = placement->bounding_radius_m;
    const double height = mean_height(tracer, placement);
    const double ground = placement->centre[1];
    const double altitude = tracer->view.altitude_m;
    struct chain_reach reach;
    reach.around_m = radius + fmax(REACH_AROUND * radius,
                                   fmin(REACH_AROUND * height, heard_reach(tracer, placement)));
    /* seabed that sees the sonar steeper than 45 degrees fills many rays, and matters little */
    const double wanted = radius + REACH_TO_MIRROR * height * ground / altitude;
    reach.towards_sonar_m = fmax(reach.around_m, fmin(wanted, ground - altitude));
    return reach;
}

#define PATCH_RAYS_PER_BIN  1.0 /* brute force */
#define SEABED_RAYS_PER_BIN 4.0 /* near the objects; fewer with distance, by Russian roulette */
/* An object is small, and what it mirrors, or sends to the sea surface, spreads far; else its rough
 * part matters between objects. */
#define OBJECT_RAYS_PER_BIN 16.0
#define ROUGH_RAYS_PER_BIN  2.0 /* where the seabed's rays stand for its own */

static struct span strips_between(const struct tracer *tracer, const struct line_grid *grid,
                                  double first_x, double last_x)
{
    const double per_row = grid->strips_per_row;
    const double first = floor((view_row_of_x(&tracer->view, first_x) + 0.5) * per_row) - 1.0;
    const double last = floor((view_row_of_x(&tracer->view, last_x) + 0.5) * per_row) + 1.0;
    const struct span strips = {(int32_t)first, (int32_t)(last - first) + 1};
    return strips;
}

/* Where seabed can be that exchanges sound with some object. */
struct surroundings {
    double first_x, last_x;         /* along-track, m */
    double near_ground, far_ground; /* range, m */
};

static struct surroundings surroundings_of_objects(const struct tracer *tracer)
{
    struct surroundings around = {INFINITY, -INFINITY, INFINITY, -INFINITY};
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct placement *placement = &tracer->placements[i];
        const struct chain_reach reach = chain_reach_of(tracer, placement);
        const double ground = placement->centre[1];
        around.first_x = fmin(around.first_x, placement->centre[0] - reach.around_m);
        around.last_x = fmax(around.last_x, placement->centre[0] + reach.around_m);
        around.near_ground = fmin(around.near_ground, ground - reach.towards_sonar_m);
        around.far_ground = fmax(around.far_ground, ground + reach.around_m);
    }
    return around;
}

static sonject_status init_seabed_fan(struct chain_fan *fan, struct tracer *tracer,
                                      const struct line_grid *grid, double central)
{
    const struct patch_view *view = &tracer->view;
    const struct surroundings around = surroundings_of_objects(tracer);
    /* an echo never comes before that of its first hit, so seabed beyond the patch has none in it
     */
    const double patch_end = view_ground_range(view, line_grid_far_end(grid, view));
    const double far = water_way_grazing(&view->water, fmin(around.far_ground, patch_end), 0.0);
    const double near = around.near_ground > 0.0
                            ? water_way_grazing(&view->water, around.near_ground, 0.0)
                            : 0.5 * PI;
    struct grazing_angles edges = {near, far};
    if (tracer->relief)
        edges = grazing_over_relief(tracer, edges);
    fan->strips = strips_between(tracer, grid, around.first_x, around.last_x);
    fan->record.only_object = -1;
    return fan_set_rays(&fan->record, tracer->report, central - edges.near, central - edges.far,
                        fan_elevation_step(tracer, grid, far, SEABED_RAYS_PER_BIN));
}

static sonject_status init_object_fan(struct chain_fan *fan, struct tracer *tracer,
                                      const struct line_grid *grid, double central, uint32_t object)
{
    static const double along[3] = {1.0, 0.0, 0.0};
    const struct placement *placement = &tracer->placements[object];
    const double grazing = placement_grazing(placement, &tracer->view);
    const struct elevations edges = elevations_of_object(tracer, object, &tracer->view.water);
    const double half_length = placement_half_extent(placement, along);
    const double middle = central - grazing;
    const sonject_material_params *material = tracer->placements[object].material;
    const bool is_mirror =
        material->reflection_kind == SONJECT_REFLECTION_FLUID || material->reflection != 0.0;
    const bool has_reverse = tracer->scene->injection.column_rule == SONJECT_COLUMNS_FOCUSED &&
                             tracer->scene->sonar.transducer_side_m == 0.0;
    const bool finds_surface = sea_surface_is_in_chains(tracer, grid);
    const double rays_per_bin =
        is_mirror || !has_reverse || finds_surface ? OBJECT_RAYS_PER_BIN : ROUGH_RAYS_PER_BIN;
    fan->strips = strips_between(tracer, grid, placement->centre[0] - half_length,
                                 placement->centre[0] + half_length);
    fan->record.only_object = (int32_t)object;
    return fan_set_rays(&fan->record, tracer->report, middle + edges.lowest, middle + edges.highest,
                        fan_elevation_step(tracer, grid, grazing, rays_per_bin));
}

uint32_t chain_fan_count(const struct tracer *tracer)
{
    return tracer->scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE
               ? 1
               : 1 + tracer->part_count;
}

sonject_status chain_fan_init(struct chain_fan *fan, struct tracer *tracer,
                              const struct line_grid *grid, bool has_map, uint32_t i)
{
    const struct patch_view *view = &tracer->view;
    double origin[3];
    patch_fan_origin(origin, view);
    const double central = water_way_grazing(&view->water, origin[1], 0.0);
    sonject_status status = patch_fan_init(&fan->record, tracer, grid, has_map, PATCH_RAYS_PER_BIN);
    fan->strips = grid->strips;
    fan->record.only_object = -2;
    if (status == SONJECT_OK && chain_fan_count(tracer) > 1)
        status = i == 0 ? init_seabed_fan(fan, tracer, grid, central)
                        : init_object_fan(fan, tracer, grid, central, i - 1);
    fan->record.stream = (uint32_t)(STREAM_CHAIN_RAYS + fan->record.only_object);
    return status;
}
