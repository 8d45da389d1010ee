#include "trace/fan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/placement.h"
#include "trace/chains.h"

#define PI             3.14159265358979323846
#define OBJECT_RAYS    16.0 /* fewest rays on a rough object: its energy is then known to 1 dB */
#define SURROUNDINGS   18.0 /* bounding radii of an object */
#define MARGIN         1.02
#define LARGEST_SINE   0.70710678118654752 /* sine of 45 degrees */
#define NULLS          2.0  /* main lobe and first side lobes: all but 3e-4 of the energy */
#define STEEPEST_SINE  0.95 /* equals that of kernels/aspects.h */
#define PIECES_FEWEST  64
#define PIECES_MOST    16384
#define OFFSET_ERROR_M 1.0e-6 /* error of a cubic in mid-piece; phases need no less */
#define NEAREST_M      1.0e-3 /* least ground range: the point is under the sonar, or behind */

void ray_table_clear(struct ray_table *table)
{
    free(table->pieces);
    memset(table, 0, sizeof *table);
}

/* Returns the height, m, where the last stretch of straight water begins, or the highest slice. */
static double edge_height(const struct ray_path *path)
{
    const struct water *water = path->water;
    if (path->comes_from_seabed)
        return 0.0;
    return water->slices < water->count
               ? fmin(water->layers[water->slices].bottom_m, path->sonar_height_m)
               : path->sonar_height_m;
}

/* Returns the lowest and highest elevation of the rays to points (ground range, height), rad above
 * the ray to the origin. Points beyond the straight water or its slices count as their edge; points
 * that no ray comes to are infinitely high. */
static struct elevations elevations_of_points(const struct ray_path *path,
                                              double origin_grazing_rad, const double (*points)[2],
                                              size_t count)
{
    struct elevations elevations = {INFINITY, -INFINITY};
    for (size_t i = 0; i < count; i++) {
        double height = points[i][1];
        if (!path->is_straight)
            height = path->comes_from_seabed ? fmax(height, 0.0) : fmin(height, edge_height(path));
        const double elevation =
            origin_grazing_rad - ray_path_grazing(path, fmax(points[i][0], NEAREST_M), height);
        elevations.lowest = fmin(elevations.lowest, elevation);
        elevations.highest = isnan(elevation) ? INFINITY : fmax(elevations.highest, elevation);
    }
    return elevations;
}

/* A frame's origin as seen on a path. */
struct aim {
    const struct ray_path *path;
    double ground_range, height, grazing, range;
    double edge;        /* height in a slice of straight rays, to which sound is followed, m */
    double speed_ratio; /* sound speed of the slice over that of the straight water */
};

/* A ray as a line where it passes closest to the origin. Growths are per rad of elevation. */
struct passing_ray {
    double offset, offset_growth, range, range_growth, spreading;
};

static struct passing_ray pass(const struct aim *aim, double elevation)
{
    const double straight = aim->grazing - elevation;
    const struct arrival ray = ray_path_arrival(aim->path, straight, aim->edge);
    const double grazing = ray.grazing_rad;
    const double beyond = ray.ground_range_m - aim->ground_range;
    const double above = aim->edge - aim->height;
    const double along = beyond * cos(grazing) - above * sin(grazing);
    const double turn =
        aim->speed_ratio == 1.0 ? 1.0 : aim->speed_ratio * sin(straight) / sin(grazing);
    struct passing_ray passing;
    passing.offset = beyond * sin(grazing) + above * cos(grazing);
    passing.offset_growth = (ray.wavefront_m - along) * turn;
    passing.range = ray.straight_range_m - along / aim->speed_ratio - aim->range;
    passing.range_growth = -passing.offset * turn / aim->speed_ratio;
    passing.spreading = ray.spreading;
    return passing;
}

/* Sets the cubic over `step` rad between two values, each with its growth per rad. */
static void cubic_between(float cubic[4], double lower, double lower_growth, double upper,
                          double upper_growth, double step)
{
    const double rise = upper - lower;
    const double first = step * lower_growth;
    const double last = step * upper_growth;
    cubic[0] = (float)lower;
    cubic[1] = (float)first;
    cubic[2] = (float)(3.0 * rise - 2.0 * first - last);
    cubic[3] = (float)(first + last - 2.0 * rise);
}

/* Returns the cubic between two rays `step` rad apart. */
static struct ray_piece_record piece_between(const struct passing_ray *lower,
                                             const struct passing_ray *upper, double step)
{
    struct ray_piece_record piece;
    cubic_between(piece.offset, lower->offset, lower->offset_growth, upper->offset,
                  upper->offset_growth, step);
    piece.range = (float)lower->range;
    piece.spreading = (float)lower->spreading;
    piece.spreading_growth = (float)(upper->spreading - lower->spreading);
    return piece;
}

/* Returns the distance, m, between cubic and ray in the middle of the piece. */
static double error_between(const struct aim *aim, const struct passing_ray *lower,
                            const struct passing_ray *upper, double middle, double step)
{
    const double cubic = 0.5 * (lower->offset + upper->offset) +
                         0.125 * step * (lower->offset_growth - upper->offset_growth);
    return fabs(cubic - pass(aim, middle).offset);
}

/* Fills in pieces of one slice; returns the worst error, m. ranges: pieces of ranges, or NULL. */
static double fill_pieces(const struct aim *aim, const struct ray_table_record *record,
                          struct ray_piece_record *pieces, struct ray_piece_record *ranges)
{
    const double step = record->radians_per_piece;
    double worst = 0.0;
    double elevation = record->first_elevation;
    struct passing_ray lower = pass(aim, elevation);
    for (int32_t i = 0; i < record->pieces; i++) {
        const double middle = record->first_elevation + (i + 0.5) * step;
        elevation = record->first_elevation + (i + 1.0) * step;
        const struct passing_ray upper = pass(aim, elevation);
        const double error = error_between(aim, &lower, &upper, middle, step);
        worst = isfinite(error) ? fmax(worst, error) : INFINITY;
        pieces[i] = piece_between(&lower, &upper, step);
        if (ranges)
            cubic_between(ranges[i].offset, lower.range, lower.range_growth, upper.range,
                          upper.range_growth, step);
        lower = upper;
    }
    return worst;
}

/* Fills in the pieces of the straight water and its slices in the layout of struct
 * ray_table_record, and returns the worst error, m. */
static double fill_slices(struct aim *aim, const struct ray_table_record *record,
                          struct ray_piece_record *pieces)
{
    const struct water *water = aim->path->water;
    const double straight_edge =
        water->slices == 1 ? edge_height(aim->path) : water->layers[1].bottom_m;
    aim->edge = straight_edge;
    aim->speed_ratio = 1.0;
    double worst = fill_pieces(aim, record, pieces, NULL);
    pieces += record->pieces;
    for (size_t i = 1; i < water->slices; i++, pieces += 1 + 2 * record->pieces) {
        const double top =
            i + 1 < water->slices ? water->layers[i + 1].bottom_m : edge_height(aim->path);
        aim->edge = 0.5 * (water->layers[i].bottom_m + top);
        aim->speed_ratio = water->layers[i].speed_mps / water->straight_speed_mps;
        memset(pieces, 0, (1 + 2 * (size_t)record->pieces) * sizeof *pieces);
        pieces->offset[0] = (float)(water->layers[i].bottom_m - aim->height);
        pieces->offset[1] = (float)aim->speed_ratio;
        pieces->offset[2] = (float)(1.0 / aim->speed_ratio);
        worst = fmax(worst, fill_pieces(aim, record, pieces + 1, pieces + 1 + record->pieces));
    }
    return worst;
}

/* Appends the rays of a path, over the elevations that a launch needs, and describes them in the
 * record. The frame's origin has the ground range and the height given. A straight path needs no
 * pieces. Errors: INPUT (rays turn back, or so nearly that no cubic follows them), MEMORY. */
static sonject_status ray_table_add(struct ray_table *table, struct report *report,
                                    const struct ray_path *path, double ground_range_m,
                                    double height_m, struct elevations elevations,
                                    struct ray_table_record *record)
{
    memset(record, 0, sizeof *record);
    record->ground_range = (float)ground_range_m;
    if (path->is_straight)
        return SONJECT_OK;
    if (!isfinite(elevations.highest)) /* no number of pieces covers these elevations */
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "some sound towards the objects or close to them turns back above "
                              "the lowest layer of water: move the patch inwards, or use smaller "
                              "objects");
    struct aim aim = {path,
                      ground_range_m,
                      height_m,
                      ray_path_grazing(path, ground_range_m, height_m),
                      ray_path_range(path, ground_range_m, height_m),
                      0.0,
                      1.0};
    const size_t slices = path->water->slices;
    record->slices = (int32_t)slices;
    record->first_piece = (int32_t)table->count;
    record->first_elevation = (float)elevations.lowest;
    double error = INFINITY;
    for (int32_t count = PIECES_FEWEST; count <= PIECES_MOST && error > OFFSET_ERROR_M;
         count *= 4) {
        const size_t total = table->count + (size_t)count + (slices - 1) * (1 + 2 * (size_t)count);
        struct ray_piece_record *pieces = realloc(table->pieces, total * sizeof *pieces);
        CHECK_MEMORY(report, pieces, "the rays through the layers");
        table->pieces = pieces;
        record->pieces = count;
        record->radians_per_piece = (float)((elevations.highest - elevations.lowest) / count);
        record->pieces_per_radian = 1.0f / record->radians_per_piece;
        error = fill_slices(&aim, record, pieces + table->count);
    }
    table->count += (size_t)record->pieces + (slices - 1) * (1 + 2 * (size_t)record->pieces);
    if (!(error <= OFFSET_ERROR_M))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "sound reaches %.1f m ground range so near to total reflection by a "
                              "layer of water that its rays cannot be told apart: move the patch "
                              "inwards",
                              ground_range_m);
    return SONJECT_OK;
}

void patch_fan_origin(double origin[3], const struct patch_view *view)
{
    const double first = fmax(0.0, view_column_of_range(view, view_bottom_range(view)));
    const double middle = view_processor_range(view, 0.5 * (first + (double)(view->columns - 1)));
    origin[0] = view_x_of_row(view, 0.5 * (double)(view->rows - 1));
    origin[1] = view_ground_range(view, middle);
    origin[2] = 0.0;
}

/* The seabed and the heights that rays of the patch's frame come to. */
struct region {
    double near, far;   /* ground range, m */
    double bottom, top; /* heights, m */
};

/* Returns a little more than the reach of chains, if there are any. */
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
    const struct ray_path *path = &tracer->view.water;
    const struct region region = region_of_patch(tracer, grid);
    /* a little farther, for what is sought beside the region; much farther there may be no ray */
    const double points[4][2] = {{region.near, region.bottom},
                                 {region.near, region.top},
                                 {region.far, region.bottom},
                                 {1.05 * region.far, region.top}};
    double origin[3];
    patch_fan_origin(origin, &tracer->view);
    memset(rays, 0, sizeof *rays);
    return ray_table_add(
        rays, tracer->report, path, origin[1], origin[2],
        elevations_of_points(path, ray_path_grazing(path, origin[1], origin[2]), points, 4),
        record);
}

struct span strips_between(const struct tracer *tracer, const struct line_grid *grid,
                           double first_x, double last_x)
{
    const double per_row = grid->strips_per_row;
    const double first = floor((view_row_of_x(&tracer->view, first_x) + 0.5) * per_row) - 1.0;
    const double last = floor((view_row_of_x(&tracer->view, last_x) + 0.5) * per_row) + 1.0;
    const struct span strips = {(int32_t)first, (int32_t)(last - first) + 1};
    return strips;
}

double fan_highest_elevation(const struct tracer *tracer, double central_grazing, double lowest)
{
    const struct patch_view *view = &tracer->view;
    double highest = lowest;
    for (uint32_t i = 0; i < tracer->part_count; i++)
        if (tracer_follows(tracer, tracer->placements[i].object))
            highest =
                fmax(highest, central_grazing - placement_grazing(&tracer->placements[i], view) +
                                  elevations_of_part(tracer, i, &view->water).highest);
    return highest;
}

double fan_elevation_step(const struct tracer *tracer, const struct line_grid *grid,
                          double grazing_rad, double rays_per_bin)
{
    const struct patch_view *view = &tracer->view;
    const double bin = view->column_spacing_m / grid->bins_per_pixel / view->range_ratio;
    const double radius = ray_path_arrival(&view->water, grazing_rad, 0.0).wavefront_m;
    return fmin(tan(grazing_rad), 1.0) * bin / radius /
           (rays_per_bin * tracer->scene->injection.ray_scale);
}

double fan_step_to_objects(const struct tracer *tracer, double strip_m)
{
    double step = INFINITY;
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct placement *placement = &tracer->placements[i];
        const double size = tracer->objects[placement->object].size_m;
        const double grazing = placement_grazing(placement, &tracer->view);
        const double radius =
            ray_path_arrival(&tracer->view.water, grazing, placement->centre[2]).wavefront_m;
        if (material_is_rough(&placement->material) && tracer_follows(tracer, placement->object))
            step = fmin(step, 0.25 * PI * size * size / (OBJECT_RAYS * strip_m * radius));
    }
    return step / tracer->scene->injection.ray_scale;
}

sonject_status fan_set_rays(struct fan_record *fan, struct report *report, double lowest,
                            double highest, double step)
{
    const double rays = ceil((highest - lowest) / step);
    if (!(rays < FAN_RAYS_MAX))
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
    const struct ray_path *path = &tracer->view.water;
    const double end = relief->first_y_m + (relief->columns - 1) * relief->column_step_m;
    const struct grazing_angles angles = {
        fmax(plane.near, ray_path_grazing(path, relief->first_y_m, relief->lowest_m)),
        fmin(plane.far, ray_path_grazing(path, end, relief->highest_m))};
    return angles;
}

void patch_fan_aim(struct fan_record *fan, const struct tracer *tracer,
                   const struct line_grid *grid, bool has_map)
{
    const struct patch_view *view = &tracer->view;
    double origin[3];
    patch_fan_origin(origin, view);
    fan_record_init(fan, tracer, origin, grid);
    fan->map_rows = has_map ? (int32_t)view->rows : 0;
    fan->map_columns = has_map ? (int32_t)view->columns : 0;
}

sonject_status patch_fan_init(struct fan_record *fan, struct tracer *tracer,
                              const struct line_grid *grid, bool has_map, double rays_per_bin)
{
    const struct patch_view *view = &tracer->view;
    double origin[3];
    patch_fan_origin(origin, view);
    patch_fan_aim(fan, tracer, grid, has_map);
    const double central = ray_path_grazing(&view->water, origin[1], 0.0);
    const double near = view_grazing(view, line_grid_near_end(grid, view));
    const double far = view_grazing(view, line_grid_far_end(grid, view));
    struct grazing_angles edges = {near, far};
    if (tracer->relief)
        edges = grazing_over_relief(tracer, edges);
    return fan_set_rays(fan, tracer->report, central - edges.near,
                        fan_highest_elevation(tracer, central, central - edges.far),
                        fmin(fan_elevation_step(tracer, grid, far, rays_per_bin),
                             fan_step_to_objects(tracer, (double)fan->strip_width)));
}

struct elevations elevations_of_part(const struct tracer *tracer, uint32_t part,
                                     const struct ray_path *path)
{
    const struct placement *placement = &tracer->placements[part];
    const double *centre = placement->centre;
    const double grazing = ray_path_grazing(path, centre[1], centre[2]);
    const double there = ray_path_direction(path, centre[1], centre[2]);
    const double upward[3] = {0.0, sin(there), cos(there)};
    const double across = MARGIN * placement_half_extent(placement, upward);
    const double along = placement->bounding_radius_m;
    double corners[4][2];
    for (int i = 0; i < 4; i++) {
        const double up = i & 1 ? across : -across;
        const double away = i & 2 ? along : -along;
        corners[i][0] = centre[1] + up * sin(there) + away * cos(there);
        corners[i][1] = centre[2] + up * cos(there) - away * sin(there);
    }
    return elevations_of_points(path, grazing, (const double(*)[2])corners, 4);
}

void fan_aim_at_part(struct fan_record *fan, const struct tracer *tracer, uint32_t part,
                     const struct ray_path *path, double cell_m)
{
    const double *centre = tracer->placements[part].centre;
    const double grazing = ray_path_grazing(path, centre[1], centre[2]);
    const double radius = ray_path_arrival(path, grazing, centre[2]).wavefront_m;
    const struct elevations edges = elevations_of_part(tracer, part, path);
    const double rays = ceil((edges.highest - edges.lowest) * radius / cell_m) + 1.0;
    fan->rays = (uint32_t)rays;
    fan->first_elevation = (float)edges.lowest;
    fan->elevation_step = (float)((edges.highest - edges.lowest) / rays);
}

sonject_status part_rays_add(struct ray_table *rays, const struct tracer *tracer, uint32_t part,
                             const struct ray_path *path, struct ray_table_record *record)
{
    const double *centre = tracer->placements[part].centre;
    return ray_table_add(rays, tracer->report, path, centre[1], centre[2],
                         elevations_of_part(tracer, part, path), record);
}

double aspects_sine(const struct tracer *tracer)
{
    const double aperture = tracer->scene->sonar.aperture_rad;
    if (tracer->scene->sonar.kind != SONJECT_SONAR_SYNTHETIC)
        return 0.0;
    if (aperture >= 0.0)
        return sin(0.5 * aperture);
    return fmin(0.25 * tracer->view.wavelength_m / tracer->response.resolution_m, LARGEST_SINE);
}

double aspects_slide(const struct tracer *tracer, double length_m)
{
    const double sine = aspects_sine(tracer);
    return length_m * sine / sqrt(1.0 - sine * sine);
}

/* Returns the true range of the grid's end, m. */
static double range_of_end(const struct tracer *tracer, const struct line_grid *grid)
{
    return line_grid_far_end(grid, &tracer->view) / tracer->view.range_ratio;
}

void aspects_record_init(struct fan_record *fan, const struct tracer *tracer,
                         const struct line_grid *grid)
{
    const struct point_response *response = &tracer->response;
    struct aspects_record *aspects = &fan->aspects;
    double square = 1.0;
    aspects->sine = (float)aspects_sine(tracer);
    if (!(aspects->sine > 0.0f))
        return;
    aspects->end = (float)(range_of_end(tracer, grid) - fan->reference_range);
    aspects->terms = response->terms;
    for (int term = 0; term < response->terms; term++) {
        aspects->weights[term] = (float)(2.0 * response->weights[term]);
        square += 2.0 * response->weights[term] * response->weights[term];
    }
    aspects->scale = (float)(1.0 / square);
}

int32_t aspects_relief_halo(const struct tracer *tracer, const struct line_grid *grid)
{
    const double height = fmax(fabs(tracer_lowest_seabed(tracer)), tracer_highest_seabed(tracer));
    if (height == 0.0 || !(aspects_sine(tracer) > 0.0))
        return 0;
    /* the slide is from the mean plane to the relief along the ray that is closest to level */
    const double range = range_of_end(tracer, grid) * tracer->view.range_ratio;
    const double slide = aspects_slide(tracer, height / sin(view_grazing(&tracer->view, range)));
    return (int32_t)ceil(slide * grid->strips_per_row / tracer->view.row_spacing_m) + 1;
}

/* Returns the largest direction cosine of rays off the beam's middle, along the long side. */
static double reach_of_beam(const struct tracer *tracer)
{
    return fmin(NULLS * tracer->view.wavelength_m / tracer->scene->sonar.array_length_m, 1.0);
}

double beam_largest_sine(const struct tracer *tracer)
{
    double axes[3][3];
    sonar_array_axes(axes, &tracer->scene->sonar, tracer->view.is_mirrored);
    const double slope = hypot(axes[0][1], axes[0][2]) / axes[0][0];
    return fmin(slope / hypot(1.0, slope) + reach_of_beam(tracer) / axes[0][0], STEEPEST_SINE);
}

double beam_largest_weight(const struct tracer *tracer, const struct fan_record *fan)
{
    const double sine = beam_largest_sine(tracer);
    const double cosine = sqrt(1.0 - sine * sine);
    return 6.0 * sine * 2.0 * fan->reference_range / (fan->strip_width * pow(cosine, 3.0));
}

void beam_record_init(struct fan_record *fan, const struct tracer *tracer)
{
    const sonject_sonar_params *sonar = &tracer->scene->sonar;
    const struct patch_view *view = &tracer->view;
    double axes[3][3];
    sonar_array_axes(axes, sonar, view->is_mirrored);
    fan->beam.reach = (float)reach_of_beam(tracer);
    fan->beam.length = (float)(sonar->array_length_m / view->wavelength_m);
    fan->beam.height = (float)(sonar->array_height_m / view->wavelength_m);
    for (int k = 0; k < 3; k++) {
        fan->beam.along[k] = (float)axes[0][k];
        fan->beam.across[k] = (float)axes[2][k];
    }
}

double beam_nearest(const struct tracer *tracer, const struct line_grid *grid)
{
    const double sine = beam_largest_sine(tracer);
    return line_grid_near_end(grid, &tracer->view) * sqrt(1.0 - sine * sine);
}
