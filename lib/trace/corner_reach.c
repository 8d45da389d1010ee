#include "trace/corner_reach.h"

#include <math.h>

#include "trace/corners.h"
#include "trace/smooth.h"

#define BINS_MAX           1.0e9 /* beyond any patch, within a 32-bit number */
#define FINER_MAX          2.0   /* 4 times the rays */
#define WIDEST_WAVELENGTHS 0.5   /* of a cell where it meets the next face */

static bool is_smooth(const struct tracer *tracer, uint32_t part)
{
    return material_is_smooth(tracer->placements[part].material);
}

/* As is_convex in kernels/intersection.h. */
static bool is_convex(const struct placement *placement)
{
    const struct shape_size *size = &placement->size;
    return !size->mesh && placement->shape != SONJECT_SHAPE_TORUS && !size->nose.is_open &&
           !size->tail.is_open;
}

bool corners_may_echo(const struct tracer *tracer, uint32_t part)
{
    uint32_t smooth_parts = 0;
    for (uint32_t i = 0; i < tracer->part_count; i++)
        smooth_parts += is_smooth(tracer, i);
    return tracer->scene->injection.interactions >= 2 && is_smooth(tracer, part) &&
           (smooth_parts > 1 || !is_convex(&tracer->placements[part]));
}

void corner_pairs_begin(struct corner_pairs *pairs, const struct tracer *tracer, uint32_t part)
{
    const struct sound_source sonar = {tracer->view.water, 0, MIRROR_SEABED};
    pairs->sonar = sonar;
    pairs->has_begun = false;
    source_pairs_begin(&pairs->others, tracer, part);
}

const struct source_pair *corner_pairs_next(struct corner_pairs *pairs)
{
    const uint32_t interactions = pairs->others.tracer->scene->injection.interactions;
    if (!pairs->has_begun) {
        pairs->has_begun = true;
        pairs->pair.outgoing = pairs->pair.returning = &pairs->sonar;
        pairs->pair.number = 0;
        return &pairs->pair;
    }
    while (source_pairs_next(&pairs->others, &pairs->pair))
        if (2 + pairs->pair.outgoing->bounces + pairs->pair.returning->bounces <= interactions)
            return &pairs->pair;
    return NULL;
}

/* No less than what each further interaction may add to a path between the first and last hit: the
 * diagonal of a box around the smooth parts, or half that of one around them and their mirror
 * images in the seabed, which take two interactions. */
static double longest_step(const struct tracer *tracer)
{
    double height;
    const sonject_material_params *seabed;
    double low[3] = {INFINITY, INFINITY, INFINITY};
    double high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct placement *part = &tracer->placements[i];
        for (int axis = 0; axis < 3 && is_smooth(tracer, i); axis++) {
            low[axis] = fmin(low[axis], part->centre[axis] - part->bounding_radius_m);
            high[axis] = fmax(high[axis], part->centre[axis] + part->bounding_radius_m);
        }
    }
    const double level = hypot(high[0] - low[0], high[1] - low[1]);
    const double straight = hypot(level, high[2] - low[2]);
    if (!scene_mirror(tracer->scene, MIRROR_SEABED, &height, &seabed))
        return straight;
    return fmax(straight, 0.5 * hypot(level, 2.0 * fmax(fabs(low[2]), fabs(high[2]))));
}

struct ranges {
    double nearest, farthest;
};

static struct ranges ranges_of(const struct sound_source *source, const struct placement *placement)
{
    const double range = water_way_range(&source->way, placement->centre[1], placement->centre[2]);
    const double reach = 1.01 * placement->bounding_radius_m;
    struct ranges ranges = {range - reach, range + reach};
    return ranges;
}

/* Half of the shortest and of the longest path. */
static struct ranges half_paths(const struct tracer *tracer, uint32_t part,
                                const struct source_pair *pair)
{
    const struct placement *first = &tracer->placements[part];
    const uint32_t interactions =
        tracer->scene->injection.interactions - pair->outgoing->bounces - pair->returning->bounces;
    const struct ranges out = ranges_of(pair->outgoing, first);
    struct ranges home = {INFINITY, 0.0};
    double aside = 0.0;
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct placement *last = &tracer->placements[i];
        if (!is_smooth(tracer, i))
            continue;
        const struct ranges one = ranges_of(pair->returning, last);
        home.nearest = fmin(home.nearest, one.nearest);
        home.farthest = fmax(home.farthest, one.farthest);
        aside = fmax(aside, fabs(first->centre[0] - last->centre[0]) + first->bounding_radius_m +
                                last->bounding_radius_m);
    }
    /* the source stands beside both hits: each leg is longer by no more than aside^2 / 2 range */
    const double lengthened = aside * aside / fmax(fmin(out.nearest, home.nearest), 1e-3);
    struct ranges half;
    half.nearest = 0.5 * (out.nearest + home.nearest);
    half.farthest = 0.5 * (out.farthest + home.farthest + lengthened +
                           (interactions - 1.0) * longest_step(tracer));
    return half;
}

struct span corner_pair_bins(const struct tracer *tracer, uint32_t part,
                             const struct source_pair *pair, const struct line_grid *grid)
{
    const struct patch_view *view = &tracer->view;
    const struct ranges half = half_paths(tracer, part, pair);
    const double per_metre = grid->bins_per_pixel / view->column_spacing_m;
    const double first = (half.nearest * view->range_ratio - view->first_range_m) * per_metre;
    const double last = (half.farthest * view->range_ratio - view->first_range_m) * per_metre;
    struct span bins;
    bins.first = (int32_t)fmax(fmin(floor(first), BINS_MAX), -BINS_MAX) - 1;
    bins.count = (int32_t)fmin(ceil(last), BINS_MAX) + 2 - bins.first;
    return bins_in_patch(tracer, grid, bins);
}

struct span corner_bins(const struct tracer *tracer, uint32_t part, const struct line_grid *grid)
{
    struct corner_pairs pairs;
    const struct source_pair *pair;
    struct span bins = {0, 0};
    if (!corners_may_echo(tracer, part))
        return bins;
    corner_pairs_begin(&pairs, tracer, part);
    while ((pair = corner_pairs_next(&pairs)) != NULL)
        bins = span_join(bins, corner_pair_bins(tracer, part, pair, grid));
    return bins;
}

/* The smallest radius of curvature of a part, m; INFINITY if all its faces are flat. */
static double sharpest_curvature(const struct placement *placement)
{
    const struct shape_size *size = &placement->size;
    switch (placement->shape) {
    case SONJECT_SHAPE_SPHERE:
    case SONJECT_SHAPE_CYLINDER:
    case SONJECT_SHAPE_CAPSULE:
        return size->radius_m;
    case SONJECT_SHAPE_CONE:
    case SONJECT_SHAPE_TRUNCATED_CONE:
        return fmax(size->top_radius_m, 0.5 * size->radius_m);
    case SONJECT_SHAPE_TORUS:
        return size->ring_radius_m;
    case SONJECT_SHAPE_ELLIPSOID: {
        const double least =
            fmin(size->half_length_m, fmin(size->half_width_m, size->half_height_m));
        const double most =
            fmax(size->half_length_m, fmax(size->half_width_m, size->half_height_m));
        return least * least / most;
    }
    default:
        return INFINITY;
    }
}

/* The way from the middle of a part to that of the farthest that it may light. */
static double farthest_middle(const struct tracer *tracer, uint32_t part)
{
    const struct placement *one = &tracer->placements[part];
    double way = one->bounding_radius_m;
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct placement *other = &tracer->placements[i];
        if (is_smooth(tracer, i))
            way = fmax(way, hypot(hypot(one->centre[0] - other->centre[0],
                                        one->centre[1] - other->centre[1]),
                                  one->centre[2] - other->centre[2]));
    }
    return way;
}

/* A face of radius a spreads a cell of the wavefront by 1 + 2 D/a until it meets the next, D away.
 * Cells there are all or nothing at edges, so they must not be wide. */
double corner_rays_finer(const struct tracer *tracer, uint32_t part)
{
    const double radius = sharpest_curvature(&tracer->placements[part]);
    const double spread = 1.0 + 2.0 * farthest_middle(tracer, part) / radius;
    return fmin(fmax(spread * GLINT_CELL_WAVELENGTHS / WIDEST_WAVELENGTHS, 1.0), FINER_MAX);
}
