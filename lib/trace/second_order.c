/* Paths of two interactions between seabed and target, sampled by the range cells that their echoes
 * end in (kernels/second_order.h). */
#include <math.h>

#include "trace/chains.h"
#include "trace/fan.h"
#include "trace/image_sources.h"

#define PI              3.14159265358979323846
#define SAMPLES_A_PIXEL 12.0
/* The share of the seabed's echo in a cell below which a target has fewer samples. */
#define FULL_SHARE 0.001
#define MARGIN     1.001
#define NEAREST_M  0.01 /* least ground range */

bool second_order_is_sampled(const struct tracer *tracer, const struct line_grid *grid)
{
    const sonject_injection_params *injection = &tracer->scene->injection;
    return injection->interactions > 1 && injection->estimator == SONJECT_ESTIMATOR_CONNECT &&
           injection->column_rule == SONJECT_COLUMNS_FOCUSED &&
           tracer->scene->sonar.transducer_side_m == 0.0 && !sea_surface_is_in_chains(tracer, grid);
}

static double samples_a_cell(const struct tracer *tracer, const struct line_grid *grid)
{
    const double wanted =
        SAMPLES_A_PIXEL * tracer->scene->injection.ray_scale / grid->strips_per_row;
    return fmax(1.0, floor(wanted + 0.5));
}

/* Returns the most that a part scatters. A smooth surface scatters what roughness takes out of the
 * specular direction, both coming and going. */
static double brightness_of_part(const struct tracer *tracer, uint32_t part)
{
    const sonject_material_params *material = &tracer->placements[part].material;
    const double phase = 4.0 * PI * material->roughness_m / tracer->view.wavelength_m;
    const double scattered = material_is_smooth(material) ? -expm1(-phase * phase) : 1.0;
    return material_brightness(material) * scattered * scattered;
}

/* The window of the wavefront that a part fills. */
struct target_window {
    double half_width_m, lowest, elevations;
    double area_m2;
};

static struct target_window window_of_part(const struct tracer *tracer, uint32_t part)
{
    static const double along[3] = {1.0, 0.0, 0.0};
    const struct placement *placement = &tracer->placements[part];
    const struct ray_path *water = &tracer->view.water;
    const struct elevations edges = elevations_of_part(tracer, part, water);
    const double grazing = placement_grazing(placement, &tracer->view);
    struct target_window window;
    window.half_width_m = MARGIN * placement_half_extent(placement, along);
    window.lowest = edges.lowest;
    window.elevations = edges.highest - edges.lowest;
    window.area_m2 = 2.0 * window.half_width_m * window.elevations *
                     ray_path_arrival(water, grazing, placement->centre[2]).wavefront_m;
    return window;
}

static double top_of_part(const struct tracer *tracer, uint32_t part)
{
    static const double upward[3] = {0.0, 0.0, 1.0};
    const struct placement *placement = &tracer->placements[part];
    const double height = placement->centre[2] - tracer_lowest_seabed(tracer);
    return fmax(height + placement_half_extent(placement, upward), 0.01);
}

/* Returns a part's weight, m^2. 8: both ways, whose amplitudes add, and two places on seabed. */
static double weight_of_part(const struct tracer *tracer, uint32_t part)
{
    return 8.0 * window_of_part(tracer, part).area_m2 * brightness_of_part(tracer, part) /
           FULL_SHARE;
}

/* Returns the distance, m, from which on a part has no samples. The weight falls with its cube. */
static double reach_of_part(const struct tracer *tracer, uint32_t part)
{
    return cbrt(MARGIN * weight_of_part(tracer, part) * top_of_part(tracer, part) / LEAST_WEIGHT);
}

static bool is_rough(const struct tracer *tracer, uint32_t part)
{
    return material_is_rough(&tracer->placements[part].material);
}

/* The cells and strips where an object's samples may end. */
struct sampled_region {
    struct span cells, strips;
};

static struct sampled_region region_of_object(const struct tracer *tracer,
                                              const struct line_grid *grid, uint32_t object)
{
    const struct placed_object *placed = &tracer->objects[object];
    const struct patch_view *view = &tracer->view;
    const double per_pixel = grid->bins_per_pixel;
    double nearest = INFINITY, farthest = 0.0, first_x = INFINITY, last_x = -INFINITY;
    struct sampled_region region = {{0, 0}, {0, 0}};
    for (uint32_t i = placed->first_part; i < placed->first_part + placed->part_count; i++) {
        if (!is_rough(tracer, i))
            continue;
        const struct placement *placement = &tracer->placements[i];
        const double range = placement_range(placement, view);
        const double reach = reach_of_part(tracer, i);
        nearest = fmin(nearest, range - 1.02 * placement->bounding_radius_m);
        farthest = fmax(farthest, range + reach);
        first_x = fmin(first_x, placement->centre[0] - 0.5 * reach);
        last_x = fmax(last_x, placement->centre[0] + 0.5 * reach);
    }
    if (!(farthest > 0.0))
        return region;
    const double first = fmax(floor(grid->bins.first / per_pixel),
                              floor(view_column_of_range(view, nearest * view->range_ratio)) - 1.0);
    const double end = fmin(ceil((grid->bins.first + grid->bins.count) / per_pixel) + 1.0,
                            ceil(view_column_of_range(view, farthest * view->range_ratio)) + 2.0);
    region.cells.first = (int32_t)fmin(first, end);
    region.cells.count = (int32_t)fmax(0.0, end - first);
    /* echoes close to a strip's edge may count as the next strip's */
    const struct span strips = {grid->strips.first - 1, grid->strips.count + 2};
    if (region.cells.count > 0)
        region.strips = span_overlap(strips_between(tracer, grid, first_x, last_x), strips);
    return region;
}

static void target_record_init(struct target_record *record, const struct tracer *tracer,
                               const struct line_grid *grid, uint32_t part, const double origin[3])
{
    const struct placement *placement = &tracer->placements[part];
    const struct ray_path *water = &tracer->view.water;
    const struct target_window window = window_of_part(tracer, part);
    const double central = ray_path_grazing(water, origin[1], 0.0);
    const double grazing = placement_grazing(placement, &tracer->view);
    const double radius = placement->bounding_radius_m;
    const double strip = tracer->view.row_spacing_m / grid->strips_per_row;
    const double range =
        placement_range(placement, &tracer->view) - ray_path_range(water, origin[1], 0.0);
    const double least_ground =
        placement->centre[1] - chain_reach_of(tracer, placement).towards_sonar_m;
    record->centre_x = (float)(placement->centre[0] - origin[0]);
    record->range = (float)range;
    record->nearest_range = (float)(range - 1.01 * radius);
    record->square_radius = (float)(radius * radius);
    record->first_x = (float)(placement->centre[0] - origin[0] - window.half_width_m);
    record->width = (float)(2.0 * window.half_width_m);
    record->first_elevation = (float)(central - grazing + window.lowest);
    record->elevations = (float)window.elevations;
    record->least_y = (float)(fmax(least_ground, NEAREST_M) - origin[1]);
    record->top = (float)top_of_part(tracer, part);
    record->weight = (float)weight_of_part(tracer, part);
    const double step =
        fan_elevation_step(tracer, grid, grazing, chain_rays_per_bin(tracer, grid, part));
    record->rays = (float)(ceil(window.elevations / step) / (strip * window.elevations));
    record->part = (int32_t)part;
}

int32_t second_order_target(const struct tracer *tracer, uint32_t part)
{
    int32_t count = 0;
    for (uint32_t i = 0; i < part; i++)
        count += is_rough(tracer, i);
    return count;
}

void second_order_init(struct chain_record *record, struct target_spheres *spheres,
                       const struct tracer *tracer, const struct line_grid *grid,
                       const double origin[3])
{
    struct target_record *target =
        (struct target_record *)(void *)((char *)spheres->records + spheres->bytes);
    record->target_words = (uint32_t)(spheres->bytes / sizeof(float));
    record->cell_samples = (int32_t)samples_a_cell(tracer, grid);
    record->cell_bins = (int32_t)grid->bins_per_pixel;
    record->first_bin = grid->bins.first;
    for (uint32_t object = 0; object < tracer->scene->object_count; object++) {
        const struct placed_object *placed = &tracer->objects[object];
        const uint32_t end = placed->first_part + placed->part_count;
        const struct span cells = region_of_object(tracer, grid, object).cells;
        const int32_t first = second_order_target(tracer, placed->first_part);
        const int32_t count = second_order_target(tracer, end) - first;
        for (uint32_t i = placed->first_part; i < end; i++) {
            if (!is_rough(tracer, i))
                continue;
            target_record_init(target, tracer, grid, i, origin);
            target->first_target = first;
            target->targets = count;
            target->first_cell = cells.first;
            target->cells = cells.count;
            target++;
            spheres->bytes += sizeof *target;
        }
    }
}

void second_order_fan_init(struct chain_fan *fan, const struct tracer *tracer,
                           const struct line_grid *grid, uint32_t object)
{
    const struct sampled_region region = region_of_object(tracer, grid, object);
    const int64_t samples = (int64_t)samples_a_cell(tracer, grid);
    struct fan_record *record = &fan->record;
    record->target = second_order_target(tracer, tracer->objects[object].first_part);
    record->is_sample = 1;
    record->first_ray =
        (uint32_t)(samples * ((int64_t)tracer->view.first_column + region.cells.first));
    record->rays = (uint32_t)(samples * region.cells.count);
    record->stream = (uint32_t)(STREAM_SECOND_ORDER + object);
    fan->strips = region.strips;
}

double second_order_most(const struct tracer *tracer, const struct line_grid *grid)
{
    double most = 0.0;
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct target_window window = window_of_part(tracer, i);
        most = fmax(most, is_rough(tracer, i)
                              ? 2.0 * window.half_width_m * window.elevations *
                                    material_brightness(&tracer->placements[i].material)
                              : 0.0);
    }
    return most / samples_a_cell(tracer, grid);
}
