#include "trace/image_sources.h"

#include <math.h>
#include <string.h>

#include "trace/fan.h"

#define MORE_BOUNCES_MAX   ((SOURCES_MAX - 1) / 2)
#define PI                 3.14159265358979323846
#define BINS_MAX           1.0e9 /* exceeds any patch, and fits a 32-bit number */
#define GLINT_EXPONENT_MAX 12.0
#define LOSS_EXPONENT_MAX  30.0 /* boundaries that keep less than exp(-30) return nothing */

bool scene_boundary(const struct scene *scene, enum boundary kind, double *height_m,
                    const sonject_material_params **material)
{
    if (kind == BOUNDARY_SEABED) {
        *height_m = 0.0;
        *material = &scene->seabed.forward;
        return material_is_smooth(*material);
    }
    *height_m = scene->surface.water_depth_m;
    *material = &scene->surface.material;
    return *height_m > 0.0 && material_is_smooth(*material);
}

static enum boundary opposite(enum boundary kind)
{
    return kind == BOUNDARY_SEABED ? BOUNDARY_SURFACE : BOUNDARY_SEABED;
}

/* Finds the image of a source in the next boundary; returns false if there is no such boundary. */
static bool image_of(const struct scene *scene, const struct water *water,
                     const struct sound_source *source, enum boundary kind,
                     struct sound_source *image)
{
    double boundary_height;
    const sonject_material_params *material;
    if (!scene_boundary(scene, kind, &boundary_height, &material))
        return false;
    image->bounces = source->bounces + 1;
    image->last_boundary = kind;
    image->path = ray_path_image(water, scene->sonar.altitude_m, scene->surface.water_depth_m,
                                 image->bounces, kind == BOUNDARY_SEABED);
    return true;
}

size_t sources_list(const struct scene *scene, const struct water *water, uint32_t bounces,
                    struct sound_source sources[SOURCES_MAX])
{
    const uint32_t limit = bounces < MORE_BOUNCES_MAX ? bounces : MORE_BOUNCES_MAX;
    size_t count = 1;
    sources[0].path = ray_path_direct(water, scene->sonar.altitude_m);
    sources[0].bounces = 0;
    sources[0].last_boundary = BOUNDARY_SEABED;
    if (limit == 0)
        return count;
    count += image_of(scene, water, &sources[0], BOUNDARY_SEABED, &sources[count]);
    count += image_of(scene, water, &sources[0], BOUNDARY_SURFACE, &sources[count]);
    /* a level line cannot meet the same boundary twice in turn */
    for (size_t i = 1; i < count && sources[i].bounces < limit; i++)
        count += image_of(scene, water, &sources[i], opposite(sources[i].last_boundary),
                          &sources[count]);
    return count;
}

/* Returns the range from a source's track to the object's centre, m. */
static double source_range(const struct sound_source *source, const struct placement *placement)
{
    return ray_path_range(&source->path, placement->centre[1], placement->centre[2]);
}

/* Returns the grazing angle, rad, of the sound that comes from a source to the object's centre. */
static double source_grazing(const struct sound_source *source, const struct placement *placement)
{
    return ray_path_grazing(&source->path, placement->centre[1], placement->centre[2]);
}

/* Returns half the path by way of the object's centre, m. */
static double half_path(const struct image_pair *pair, const struct placement *placement)
{
    return 0.5 *
           (source_range(pair->outgoing, placement) + source_range(pair->returning, placement));
}

/* Returns how far the object's points lie before or behind its centre, seen from a source, m: its
 * extent along the line of sight, and the wavefront's curvature at the bounding sphere's edge. */
static double reach_from(const struct sound_source *source, const struct placement *placement)
{
    const double grazing = source_grazing(source, placement);
    const double radius =
        ray_path_arrival(&source->path, grazing, placement->centre[2]).wavefront_m;
    const double there =
        ray_path_direction(&source->path, placement->centre[1], placement->centre[2]);
    const double sight[3] = {0.0, cos(there), -sin(there)};
    const double bound = placement->bounding_radius_m;
    return 1.01 * placement_half_extent(placement, sight) + bound * bound / (radius - bound);
}

struct span bins_of_ranges(const struct tracer *tracer, const struct line_grid *grid,
                           double nearest_m, double farthest_m)
{
    const struct patch_view *view = &tracer->view;
    const double per_metre = grid->bins_per_pixel / view->column_spacing_m;
    const double first = (nearest_m * view->range_ratio - view->first_range_m) * per_metre;
    const double last = (farthest_m * view->range_ratio - view->first_range_m) * per_metre;
    struct span bins;
    bins.first = (int32_t)fmax(fmin(floor(first), BINS_MAX), -BINS_MAX) - 1;
    bins.count = (int32_t)fmin(ceil(last), BINS_MAX) + 2 - bins.first;
    return bins;
}

struct span image_pair_bins(const struct tracer *tracer, uint32_t part,
                            const struct image_pair *pair, const struct line_grid *grid)
{
    const struct placement *placement = &tracer->placements[part];
    const double range = half_path(pair, placement);
    const double reach =
        0.5 * (reach_from(pair->outgoing, placement) + reach_from(pair->returning, placement));
    return bins_of_ranges(tracer, grid, range - reach, range + reach);
}

struct span image_pair_bins_in_patch(const struct tracer *tracer, uint32_t part,
                                     const struct image_pair *pair, const struct line_grid *grid)
{
    return bins_in_patch(tracer, grid, image_pair_bins(tracer, part, pair, grid));
}

struct span bins_in_patch(const struct tracer *tracer, const struct line_grid *grid,
                          struct span bins)
{
    const int32_t pulse = pulse_tail_bins(&tracer->view, &tracer->response, grid->bins_per_pixel);
    const int32_t end_of_patch =
        (int32_t)((tracer->view.columns - 1) * grid->bins_per_pixel) + 1 + pulse;
    const int32_t end = bins.first + bins.count;
    bins.first = bins.first > -pulse ? bins.first : -pulse;
    bins.count = (end < end_of_patch ? end : end_of_patch) - bins.first;
    bins.count = bins.count > 0 ? bins.count : 0;
    return bins;
}

/* Returns the sound speed at a boundary over that around the object. */
static double boundary_speed_ratio(const struct tracer *tracer, double height)
{
    const struct water *water = tracer->view.water.water;
    return water_layer_at(water, height)->speed_mps / water->straight_speed_mps;
}

/* Returns the exponent by which the boundaries' roughness lowers the amplitude on the way from a
 * source: P^2/2 at every bounce. */
static double roughness_exponent(const struct tracer *tracer, const struct sound_source *source,
                                 const struct placement *placement)
{
    const double cosine = cos(source_grazing(source, placement));
    double exponent = 0.0;
    int kind = (int)source->last_boundary;
    for (uint32_t bounce = 0; bounce < source->bounces; bounce++, kind = 1 - kind) {
        double height;
        const sonject_material_params *material;
        if (!scene_boundary(tracer->scene, (enum boundary)kind, &height, &material))
            continue;
        const double ratio = boundary_speed_ratio(tracer, height);
        const double sine = sqrt(fmax(0.0, 1.0 - pow(cosine * ratio, 2.0)));
        const double phase =
            4.0 * PI * material->roughness_m * sine / (tracer->view.wavelength_m * ratio);
        exponent += 0.5 * phase * phase;
    }
    return exponent;
}

void image_pairs_begin(struct image_pairs *pairs, const struct tracer *tracer, uint32_t part,
                       bool has_straight, uint32_t object_hits)
{
    pairs->tracer = tracer;
    pairs->placement = &tracer->placements[part];
    pairs->count = sources_list(tracer->scene, tracer->view.water.water,
                                tracer->scene->injection.interactions - 1, pairs->sources);
    pairs->object_hits = object_hits;
    pairs->outgoing = 0;
    pairs->returning = has_straight ? 0 : 1;
}

static bool is_heard(const struct image_pairs *pairs, const struct image_pair *pair)
{
    return pairs->object_hits + pair->outgoing->bounces + pair->returning->bounces <=
               pairs->tracer->scene->injection.interactions &&
           roughness_exponent(pairs->tracer, pair->outgoing, pairs->placement) +
                   roughness_exponent(pairs->tracer, pair->returning, pairs->placement) <
               LOSS_EXPONENT_MAX;
}

bool image_pairs_next(struct image_pairs *pairs, struct image_pair *pair)
{
    for (; pairs->outgoing < pairs->count; pairs->returning = ++pairs->outgoing)
        while (pairs->returning < pairs->count) {
            pair->number = (uint32_t)(pairs->outgoing * SOURCES_MAX + pairs->returning);
            pair->outgoing = &pairs->sources[pairs->outgoing];
            pair->returning = &pairs->sources[pairs->returning++];
            if (is_heard(pairs, pair))
                return true;
        }
    return false;
}

bool part_has_glints(const struct tracer *tracer, uint32_t part)
{
    const struct placement *placement = &tracer->placements[part];
    struct image_pairs pairs;
    struct image_pair pair;
    double widest = 0.0; /* widest of the half angles */
    if (!material_is_smooth(&placement->material))
        return false;
    image_pairs_begin(&pairs, tracer, part, false, 1);
    while (image_pairs_next(&pairs, &pair))
        widest = fmax(widest, 0.5 * fabs(source_grazing(pair.outgoing, placement) -
                                         source_grazing(pair.returning, placement)));
    const double phase =
        4.0 * PI * placement->material.roughness_m * cos(widest) / tracer->view.wavelength_m;
    return 0.5 * phase * phase < GLINT_EXPONENT_MAX;
}

struct span span_join(struct span one, struct span other)
{
    if (one.count == 0 || other.count == 0)
        return one.count == 0 ? other : one;
    const int32_t end = one.first + one.count;
    const int32_t other_end = other.first + other.count;
    struct span both;
    both.first = one.first < other.first ? one.first : other.first;
    both.count = (end > other_end ? end : other_end) - both.first;
    return both;
}

struct span span_overlap(struct span one, struct span other)
{
    const int32_t end = one.first + one.count;
    const int32_t other_end = other.first + other.count;
    struct span both;
    both.first = one.first > other.first ? one.first : other.first;
    both.count = (end < other_end ? end : other_end) - both.first;
    both.count = both.count > 0 ? both.count : 0;
    return both;
}

struct span image_source_bins(const struct tracer *tracer, uint32_t part,
                              const struct line_grid *grid)
{
    struct image_pairs pairs;
    struct image_pair pair;
    struct span bins = {0, 0};
    image_pairs_begin(&pairs, tracer, part, false, 1);
    while (image_pairs_next(&pairs, &pair))
        bins = span_join(bins, image_pair_bins_in_patch(tracer, part, &pair, grid));
    return bins;
}

static struct source_record source_record_of(const struct sound_source *source,
                                             const struct placement *placement)
{
    const double grazing = source_grazing(source, placement);
    struct source_record record;
    memset(&record, 0, sizeof record);
    record.range = (float)source_range(source, placement);
    record.cosine_depression = (float)cos(grazing);
    record.sine_depression = (float)sin(grazing);
    record.bounces = (int32_t)source->bounces;
    record.last_boundary = (int32_t)source->last_boundary;
    return record;
}

static void image_pair_record_init(struct image_pair_record *record, const struct tracer *tracer,
                                   const struct placement *placement, const struct image_pair *pair)
{
    memset(record, 0, sizeof *record);
    record->outgoing = source_record_of(pair->outgoing, placement);
    record->returning = source_record_of(pair->returning, placement);
    record->echoes = pair->outgoing == pair->returning ? 1.0f : 2.0f;
    for (int kind = 0; kind < BOUNDARIES; kind++) {
        double height;
        const sonject_material_params *material;
        if (!scene_boundary(tracer->scene, (enum boundary)kind, &height, &material))
            continue;
        const double ratio = boundary_speed_ratio(tracer, height);
        record->boundaries[kind].height = (float)(height - placement->centre[2]);
        record->boundaries[kind].speed_ratio = (float)ratio;
        surface_record_init(&record->boundaries[kind].surface, material,
                            tracer->view.wavelength_m * ratio);
    }
}

sonject_status image_pair_aim(struct fan_record *fan, struct image_pair_record *record,
                              struct ray_table *rays, const struct tracer *tracer, uint32_t part,
                              const struct image_pair *pair, const struct line_grid *grid)
{
    const struct patch_view *view = &tracer->view;
    const struct placement *placement = &tracer->placements[part];
    const double range = half_path(pair, placement);
    const double cycles = 2.0 * range / view->wavelength_m;
    image_pair_record_init(record, tracer, placement, pair);
    fan_record_init(fan, tracer, placement->centre, grid);
    fan->reference_range = record->outgoing.range;
    fan->cosine_depression = record->outgoing.cosine_depression;
    fan->sine_depression = record->outgoing.sine_depression;
    fan->first_cycles = (float)(cycles - floor(cycles));
    fan->bin_at_reference = (float)((range * view->range_ratio - view->first_range_m) *
                                        grid->bins_per_pixel / view->column_spacing_m -
                                    grid->bins.first);
    sonject_status status =
        part_rays_add(rays, tracer, part, &pair->outgoing->path, &record->outgoing.table);
    THEN(status,
         part_rays_add(rays, tracer, part, &pair->returning->path, &record->returning.table));
    fan->table = record->outgoing.table;
    return status;
}
