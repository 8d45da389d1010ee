#include "trace/chains.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "trace/fan.h"
#include "trace/fouling.h"
#include "trace/object_buffer.h"

#define PI              3.14159265358979323846
#define SEABED_SHARE    8.0f /* enough to follow all rays within about two radii of a sphere */
#define TALLY_BYTES_MAX ((size_t)1 << 30)

typedef char orders_have_room[CHAIN_ORDERS_MAX == SCENE_INTERACTIONS_MAX ? 1 : -1];

/* A specular surface alone only lengthens chains of two interactions to three. Its echoes of single
 * interactions belong to the pairs of sources (image_sources.h). */
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

/* The reach around a part, in its radii, or in its mean heights if those are more. */
#define REACH_AROUND 16.0

/* The reach towards the sonar, in distances from below the part to the seabed's specular point. The
 * flatter sound comes, the nearer to the sonar that point is. Sound by way of it comes first. */
#define REACH_TO_SPECULAR_POINT 6.5

/* Returns half the sum of the heights, m, of the top and of the lowest point that is not buried. */
static double mean_height(const struct tracer *tracer, const struct placement *placement)
{
    static const double upward[3] = {0.0, 0.0, 1.0};
    const double half_extent = placement_half_extent(placement, upward);
    const double height = placement->centre[2] - tracer_lowest_seabed(tracer);
    return 0.5 * (fmax(height + half_extent, 0.0) + fmax(height - half_extent, 0.0));
}

/* Returns the distance d, m, from which on seabed is heard after the patch's last range. The half
 * path is (r_B + d + r)/2, and r is at least the altitude. The margin is for the point response. */
static double heard_reach(const struct tracer *tracer, const struct placement *placement)
{
    const struct patch_view *view = &tracer->view;
    return 2.0 * 1.02 * (view->farthest_m + view->column_spacing_m) -
           placement_range(placement, view) - view->altitude_m;
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
    const double wanted = radius + REACH_TO_SPECULAR_POINT * height * ground / altitude;
    reach.towards_sonar_m = fmax(reach.around_m, fmin(wanted, ground - altitude));
    return reach;
}

#define PATCH_RAYS_PER_BIN  1.0 /* brute force */
#define SEABED_RAYS_PER_BIN 4.0 /* near the objects; fewer with distance, by Russian roulette */
/* Rays of an object's fan in a bin. Objects are small, and their specular sound and their sound to
 * the sea surface spread far. Samples stand for the rough parts' paths to the seabed. */
#define OBJECT_RAYS_PER_BIN 32.0
#define PEAKED_RAYS_PER_BIN 16.0 /* with samples for the rest */
#define ROUGH_RAYS_PER_BIN  2.0  /* matter between objects */

/* The seabed that may exchange sound with some object. */
struct surroundings {
    double first_x, last_x;         /* along-track, m */
    double near_ground, far_ground; /* range, m */
};

static struct surroundings surroundings_of_objects(const struct tracer *tracer)
{
    struct surroundings around = {INFINITY, -INFINITY, INFINITY, -INFINITY};
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct placement *placement = &tracer->placements[i];
        if (!tracer_follows(tracer, placement->object))
            continue;
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
    /* no echo comes before that of its first hit, so seabed beyond the patch adds none */
    const double patch_end = view_ground_range(view, line_grid_far_end(grid, view));
    const double far = ray_path_grazing(&view->water, fmin(around.far_ground, patch_end), 0.0);
    const double near = around.near_ground > 0.0
                            ? ray_path_grazing(&view->water, around.near_ground, 0.0)
                            : 0.5 * PI;
    struct grazing_angles edges = {near, far};
    if (tracer->relief)
        edges = grazing_over_relief(tracer, edges);
    fan->strips = strips_between(tracer, grid, around.first_x, around.last_x);
    fan->record.only_object = -1;
    return fan_set_rays(&fan->record, tracer->report, central - edges.near, central - edges.far,
                        fan_elevation_step(tracer, grid, far, SEABED_RAYS_PER_BIN));
}

double chain_rays_per_bin(const struct tracer *tracer, const struct line_grid *grid, uint32_t part)
{
    const sonject_material_params *material = &tracer->placements[part].material;
    const bool is_peaked = material_is_smooth(material) || material->glossy_albedo > 0.0;
    if (!second_order_is_sampled(tracer, grid))
        return OBJECT_RAYS_PER_BIN;
    return is_peaked ? PEAKED_RAYS_PER_BIN : ROUGH_RAYS_PER_BIN;
}

static sonject_status init_object_fan(struct chain_fan *fan, struct tracer *tracer,
                                      const struct line_grid *grid, double central, uint32_t part)
{
    static const double along[3] = {1.0, 0.0, 0.0};
    const struct placement *placement = &tracer->placements[part];
    const double grazing = placement_grazing(placement, &tracer->view);
    const struct elevations edges = elevations_of_part(tracer, part, &tracer->view.water);
    const double half_length = placement_half_extent(placement, along);
    const double middle = central - grazing;
    fan->strips = strips_between(tracer, grid, placement->centre[0] - half_length,
                                 placement->centre[0] + half_length);
    fan->record.only_object = (int32_t)part;
    fan->record.target = second_order_target(tracer, part);
    return fan_set_rays(
        &fan->record, tracer->report, middle + edges.lowest, middle + edges.highest,
        fan_elevation_step(tracer, grid, grazing, chain_rays_per_bin(tracer, grid, part)));
}

uint32_t chain_fan_count(const struct tracer *tracer)
{
    return tracer->scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE
               ? 1
               : 1 + tracer->part_count + tracer->scene->object_count;
}

/* Aims a fan of rays or of samples for the connecting estimator. */
static sonject_status aim_fan(struct chain_fan *fan, struct tracer *tracer,
                              const struct line_grid *grid, double central, uint32_t i)
{
    const bool is_sampled = second_order_is_sampled(tracer, grid);
    if (i > tracer->part_count) {
        const uint32_t object = i - 1 - tracer->part_count;
        fan->strips.count = 0;
        if (is_sampled && tracer_follows(tracer, object))
            second_order_fan_init(fan, tracer, grid, object);
        return SONJECT_OK;
    }
    if (i > 0 && tracer_follows(tracer, tracer->placements[i - 1].object))
        return init_object_fan(fan, tracer, grid, central, i - 1);
    fan->strips.count = 0;
    if (i > 0 || (is_sampled && tracer->scene->injection.interactions == 2))
        return SONJECT_OK;
    return init_seabed_fan(fan, tracer, grid, central);
}

sonject_status chain_fan_init(struct chain_fan *fan, struct tracer *tracer,
                              const struct line_grid *grid, bool has_map, uint32_t i)
{
    const struct patch_view *view = &tracer->view;
    double origin[3];
    patch_fan_origin(origin, view);
    const double central = ray_path_grazing(&view->water, origin[1], 0.0);
    sonject_status status = patch_fan_init(&fan->record, tracer, grid, has_map, PATCH_RAYS_PER_BIN);
    fan->strips = grid->strips;
    fan->record.only_object = -2;
    if (status == SONJECT_OK && chain_fan_count(tracer) > 1)
        status = aim_fan(fan, tracer, grid, central, i);
    if (!fan->record.is_sample)
        fan->record.stream = (uint32_t)(STREAM_CHAIN_RAYS + fan->record.only_object);
    return status;
}

static sonject_material_params seabed_material(const struct tracer *tracer)
{
    sonject_material_params material = tracer->scene->seabed.forward;
    if (isnan(material.lambert))
        material.lambert = tracer->view.seabed_lambert;
    return material;
}

static void chain_record_init(struct chain_record *record, const struct chain_trace *trace,
                              const struct tracer *tracer, struct target_spheres *spheres,
                              const double origin[3])
{
    const struct scene *scene = tracer->scene;
    const sonject_material_params seabed = seabed_material(tracer);
    const bool is_brute_force = scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE;
    memset(record, 0, sizeof *record);
    record->interactions = (int32_t)scene->injection.interactions;
    record->estimator = is_brute_force ? CHAINS_BRUTE_FORCE : CHAINS_CONNECT;
    record->is_focused = scene->injection.column_rule == SONJECT_COLUMNS_FOCUSED;
    record->is_reciprocal = record->is_focused && scene->sonar.transducer_side_m == 0.0;
    record->forward_is_map = scene->seabed.forward_rule == SONJECT_FORWARD_MAP;
    record->spheres = (int32_t)spheres->count;
    record->groups = (int32_t)spheres->groups;
    record->seabed_share = SEABED_SHARE;
    for (int i = 0; i < CHAIN_ORDERS_MAX; i++)
        record->finer[i] = i + 1 < CHAIN_ORDERS_MAX
                               ? ldexpf(1.0f, trace->exponents[i + 1] - trace->exponents[i])
                               : 1.0f;
    record->first_order = (int32_t)trace->first_order;
    record->tally_first_strip = trace->grid.strips.first;
    record->tally_strips = trace->grid.strips.count;
    surface_record_init(&record->seabed, &seabed, tracer->view.wavelength_m);
    record->seabed.rough_is_apart = true; /* the rule for sound that goes straight back */
    if (second_order_is_sampled(tracer, &trace->grid))
        second_order_init(record, spheres, tracer, &trace->grid, origin);
    if (!trace->has_sea_surface)
        return;
    const sonject_material_params sea_surface = surface_material(&scene->surface);
    record->sea_surface_height = (float)scene->surface.water_depth_m;
    surface_record_init(&record->sea_surface, &sea_surface, tracer->view.wavelength_m);
}

/* The most of the sound meeting a surface that goes on, and that scatters to the source. */
struct most_sent {
    double onward, returned;
};

/* Raises the maxima to those of one more surface. is_led: directions are sampled among the targets,
 * so that each counts by its scattering and not by a share of the albedo. rough: the factor of the
 * rough part, 0 if there is none. */
static void join_surface(struct most_sent *most, const sonject_material_params *material,
                         bool is_led, double rough)
{
    const bool is_fluid = material->reflection_kind == SONJECT_REFLECTION_FLUID;
    const double specular = is_fluid ? 1.0 : material->reflection * material->reflection;
    const double scattering = rough * material_brightness(material);
    const double albedo = rough * (PI * material->lambert + material->glossy_albedo);
    most->onward = fmax(most->onward, specular + (is_led ? 2.0 * PI * scattering : albedo));
    most->returned = fmax(most->returned, scattering);
}

static struct most_sent most_sent_by_surfaces(const struct chain_trace *trace,
                                              const struct tracer *tracer, const float *map)
{
    const struct scene *scene = tracer->scene;
    const sonject_material_params seabed = seabed_material(tracer);
    const sonject_material_params sea_surface = surface_material(&scene->surface);
    struct most_sent most = {1e-12, 1e-12}; /* above 0, so that an exponent exists */
    double brightest = 1.0;
    if (map && scene->seabed.forward_rule == SONJECT_FORWARD_MAP)
        for (size_t i = 0; i < tracer->view.rows * tracer->view.columns; i++)
            brightest = fmax(brightest, map[i]);
    join_surface(&most, &seabed, true, brightest);
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const sonject_material_params *material = &tracer->placements[i].material;
        join_surface(&most, material, false,
                     material_is_rough(material) * fouling_brightest(tracer, i));
    }
    if (trace->has_sea_surface)
        join_surface(&most, &sea_surface, true, material_is_rough(&sea_surface));
    return most;
}

/* Chooses the quanta of each order. One ray brings at most about its wavefront times what surfaces
 * send on and back. Quanta leave four powers of ten above that, since sampled directions rarely
 * weigh much, and eleven below. Each order has a plane and quanta of its own: mirrors and lobes
 * raise the bound of higher orders so far that most echoes of lower ones would be rounded away. */
static sonject_status choose_quanta(struct chain_trace *trace, struct tracer *tracer,
                                    const float *map)
{
    struct fan_record fan;
    CHECK(patch_fan_init(&fan, tracer, &trace->grid, trace->has_map, 0.5));
    const double range = fan.reference_range;
    const double area = (double)fan.source_side * fan.source_side;
    struct most_sent most = most_sent_by_surfaces(trace, tracer, map);
    if (tracer->scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE && area > 0.0)
        most.returned = fmax(most.returned, most.onward * range * range / area);
    double bound = (double)fan.strip_width * fan.elevation_step * 2.0 * range * most.returned;
    const double sampled =
        second_order_is_sampled(tracer, &trace->grid)
            ? second_order_most(tracer, &trace->grid) * 2.0 * range * most.returned
            : 0.0;
    for (int i = 0; i < CHAIN_ORDERS_MAX; i++) {
        trace->exponents[i] = 37 - (int)ceil(log2(i == 1 ? fmax(bound, sampled) : bound));
        bound *= most.onward;
    }
    return SONJECT_OK;
}

static sonject_status begin_launch(struct chain_trace *trace, struct tracer *tracer,
                                   const float *map)
{
    const size_t map_bytes = map ? tracer->view.rows * tracer->view.columns * sizeof *map : 0;
    const size_t cells = line_grid_cells(&trace->grid);
    const size_t tally_bytes = trace->orders * cells * sizeof(int64_t);
    const struct part_list parts = all_parts(tracer);
    struct launch *launch = &trace->launch;
    struct target_spheres spheres;
    struct chain_record chains;
    double origin[3];
    if (cells > TALLY_BYTES_MAX / sizeof(int64_t) / trace->orders ||
        tally_bytes > tracer->device->allocation_limit)
        return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                              "the patch of %zu x %zu pixels is too large for %u interactions: use "
                              "a smaller patch",
                              tracer->view.rows, tracer->view.columns,
                              (unsigned)tracer->scene->injection.interactions);
    patch_fan_origin(origin, &tracer->view);
    CHECK(target_spheres_init(&spheres, tracer, origin));
    chain_record_init(&chains, trace, tracer, &spheres, origin);
    sonject_status status = launch_begin(launch, tracer, PROGRAM_TRACE_CHAINS, "trace_chains");
    THEN(status, launch_add(launch, tracer, LAUNCH_CHAINS, sizeof chains, &chains));
    THEN(status, launch_add_objects(launch, tracer, &parts, origin, NULL));
    THEN(status, launch_add(launch, tracer, LAUNCH_SPHERES, spheres.bytes, spheres.records));
    THEN(status, launch_add(launch, tracer, LAUNCH_MAP, map_bytes, map));
    THEN(status, launch_add(launch, tracer, LAUNCH_TALLIES, tally_bytes, NULL));
    free(spheres.records);
    return status;
}

sonject_status chain_trace_begin(struct chain_trace *trace, struct tracer *tracer, const float *map)
{
    const sonject_injection_params *injection = &tracer->scene->injection;
    const bool is_brute_force = injection->estimator == SONJECT_ESTIMATOR_BRUTE_FORCE;
    memset(trace, 0, sizeof *trace);
    if (!is_brute_force && (injection->interactions < 2 || tracer->part_count == 0))
        return SONJECT_OK;
    trace->first_order = is_brute_force ? 1 : 2;
    trace->orders = injection->interactions - trace->first_order + 1;
    line_grid_for_patch(&trace->grid, &tracer->view, &tracer->response);
    trace->has_map = map != NULL;
    trace->has_sea_surface = sea_surface_is_in_chains(tracer, &trace->grid);
    sonject_status status = choose_quanta(trace, tracer, map);
    THEN(status, patch_rays_init(&trace->launch.rays, &trace->table, tracer, &trace->grid));
    THEN(status, begin_launch(trace, tracer, map));
    if (status != SONJECT_OK)
        chain_trace_end(trace);
    return status;
}

void chain_trace_end(struct chain_trace *trace)
{
    launch_end(&trace->launch);
}

sonject_status chain_trace_strips(struct chain_trace *trace, struct tracer *tracer,
                                  const struct chain_fan *fan, struct span strips)
{
    struct fan_record *record = &trace->launch.fan;
    *record = fan->record;
    record->first_strip = strips.first;
    record->strips = strips.count;
    record->quanta = ldexpf(1.0f, trace->exponents[0]);
    record->table = trace->table;
    return launch_run(&trace->launch, tracer);
}

sonject_status chain_trace_read(struct chain_trace *trace, struct tracer *tracer, uint32_t plane,
                                float *energy)
{
    const size_t cells = line_grid_cells(&trace->grid);
    const double energy_of_quantum =
        ldexp(view_energy_scale(&tracer->view), -trace->exponents[trace->first_order - 1 + plane]);
    return tallies_read(tracer, trace->launch.buffers[LAUNCH_TALLIES], plane * cells, cells,
                        energy_of_quantum, 1, &energy);
}
