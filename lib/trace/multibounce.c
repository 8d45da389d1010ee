#include "trace/multibounce.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "trace/glints.h"
#include "trace/object_buffer.h"

#define FINER_MAX          2.0 /* 4 times the rays */
#define WIDEST_WAVELENGTHS 0.5 /* widest cell where it meets the next face */
#define PAIRS_MAX          (SOURCES_MAX * (SOURCES_MAX + 1) / 2)
#define ECHOES_A_LAUNCH    ((size_t)1 << 20)

#define ANY_OBJECT UINT32_MAX

static bool is_smooth(const struct tracer *tracer, uint32_t part)
{
    return material_is_smooth(&tracer->placements[part].material);
}

/* Returns whether a path may meet this part last. object: the object that the path keeps to. */
static bool is_met(const struct tracer *tracer, uint32_t part, uint32_t object)
{
    return is_smooth(tracer, part) &&
           (object == ANY_OBJECT || tracer->placements[part].object == object);
}

bool multibounce_may_echo(const struct tracer *tracer, uint32_t part)
{
    const struct placement *placement = &tracer->placements[part];
    uint32_t smooth_parts = 0;
    for (uint32_t i = 0; i < tracer->part_count; i++)
        smooth_parts += is_smooth(tracer, i);
    return tracer->scene->injection.interactions >= 2 && is_smooth(tracer, part) &&
           (smooth_parts > 1 || !shape_is_convex(&placement->size, placement->shape));
}

/* Returns the most, m, that each further interaction adds to a path between the first and last hit:
 * the diagonal of a box around the smooth parts or, if larger, half that of a box around the parts
 * and their images in the seabed. A way by the seabed takes two interactions. */
static double longest_step(const struct tracer *tracer, uint32_t object)
{
    double height;
    const sonject_material_params *seabed;
    double low[3] = {INFINITY, INFINITY, INFINITY};
    double high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct placement *part = &tracer->placements[i];
        for (int axis = 0; axis < 3 && is_met(tracer, i, object); axis++) {
            low[axis] = fmin(low[axis], part->centre[axis] - part->bounding_radius_m);
            high[axis] = fmax(high[axis], part->centre[axis] + part->bounding_radius_m);
        }
    }
    const double level = hypot(high[0] - low[0], high[1] - low[1]);
    const double straight = hypot(level, high[2] - low[2]);
    if (!scene_boundary(tracer->scene, BOUNDARY_SEABED, &height, &seabed))
        return straight;
    return fmax(straight, 0.5 * hypot(level, 2.0 * fmax(fabs(low[2]), fabs(high[2]))));
}

struct ranges {
    double nearest, farthest;
};

static struct ranges ranges_of(const struct sound_source *source, const struct placement *placement)
{
    const double range = ray_path_range(&source->path, placement->centre[1], placement->centre[2]);
    const double reach = 1.01 * placement->bounding_radius_m;
    struct ranges ranges = {range - reach, range + reach};
    return ranges;
}

/* Returns half of the shortest and of the longest path, m. */
static struct ranges half_paths(const struct tracer *tracer, uint32_t part,
                                const struct image_pair *pair, uint32_t object)
{
    const struct placement *first = &tracer->placements[part];
    const uint32_t interactions =
        tracer->scene->injection.interactions - pair->outgoing->bounces - pair->returning->bounces;
    const struct ranges out = ranges_of(pair->outgoing, first);
    struct ranges returned = {INFINITY, 0.0};
    double aside = 0.0;
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct placement *last = &tracer->placements[i];
        if (!is_met(tracer, i, object))
            continue;
        const struct ranges one = ranges_of(pair->returning, last);
        returned.nearest = fmin(returned.nearest, one.nearest);
        returned.farthest = fmax(returned.farthest, one.farthest);
        aside = fmax(aside, fabs(first->centre[0] - last->centre[0]) + first->bounding_radius_m +
                                last->bounding_radius_m);
    }
    /* the source is beside both hits: each leg is longer by no more than aside^2 / 2 range */
    const double lengthened = aside * aside / fmax(fmin(out.nearest, returned.nearest), 1e-3);
    struct ranges half;
    half.nearest = 0.5 * (out.nearest + returned.nearest);
    half.farthest = 0.5 * (out.farthest + returned.farthest + lengthened +
                           (interactions - 1.0) * longest_step(tracer, object));
    return half;
}

/* Returns the bins of the patch where a pair's echoes may lie; count 0 if there are none. Only the
 * size of the grid's bins is used. */
static struct span multibounce_pair_bins(const struct tracer *tracer, uint32_t part,
                                         const struct image_pair *pair,
                                         const struct line_grid *grid, uint32_t object)
{
    const struct ranges half = half_paths(tracer, part, pair, object);
    return bins_in_patch(tracer, grid, bins_of_ranges(tracer, grid, half.nearest, half.farthest));
}

struct span multibounce_bins(const struct tracer *tracer, uint32_t part,
                             const struct line_grid *grid, bool is_own)
{
    const uint32_t object = is_own ? tracer->placements[part].object : ANY_OBJECT;
    struct image_pairs pairs;
    struct image_pair pair;
    struct span bins = {0, 0};
    if (!multibounce_may_echo(tracer, part))
        return bins;
    image_pairs_begin(&pairs, tracer, part, true, 2);
    while (image_pairs_next(&pairs, &pair))
        bins = span_join(bins, multibounce_pair_bins(tracer, part, &pair, grid, object));
    return bins;
}

/* Returns the distance, m, between the middles of a part and of the farthest that it may light. */
static double farthest_middle(const struct tracer *tracer, uint32_t part)
{
    const struct placement *one = &tracer->placements[part];
    double longest = one->bounding_radius_m;
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct placement *other = &tracer->placements[i];
        if (is_smooth(tracer, i))
            longest = fmax(longest, hypot(hypot(one->centre[0] - other->centre[0],
                                                one->centre[1] - other->centre[1]),
                                          one->centre[2] - other->centre[2]));
    }
    return longest;
}

/* Returns the factor by which rays are finer than for glints. A face of radius a spreads a cell of
 * the wavefront by 1 + 2 D/a until the next face, D away. Cells there are all or nothing at edges,
 * so they must not be wide. */
static double multibounce_rays_finer(const struct tracer *tracer, uint32_t part)
{
    const double radius = tracer->placements[part].size.least_radius_of_curvature_m;
    const double spread = 1.0 + 2.0 * farthest_middle(tracer, part) / radius;
    return fmin(fmax(spread * GLINT_CELL_WAVELENGTHS / WIDEST_WAVELENGTHS, 1.0), FINER_MAX);
}

/* Returns the sub-strips halfway between first and last hits. */
static struct span mean_strips(struct span one, struct span other)
{
    struct span mean;
    mean.first = (int32_t)floor(0.5 * ((double)one.first + other.first)) - 1;
    mean.count = (int32_t)ceil(0.5 * ((double)one.first + one.count + other.first + other.count)) +
                 2 - mean.first;
    return mean;
}

void multibounce_strips_init(struct multibounce_strips *strips, const struct tracer *tracer,
                             uint32_t part)
{
    struct line_grid other;
    glint_strips_init(&strips->grid, tracer, part);
    strips->grid.bins.first = strips->grid.bins.count = 0;
    strips->first_hits = strips->grid.strips;
    struct span last_hits = strips->grid.strips;
    for (uint32_t i = 0; i < tracer->part_count; i++)
        if (is_smooth(tracer, i)) {
            glint_strips_init(&other, tracer, i);
            last_hits = span_join(last_hits, other.strips);
        }
    if (tracer->scene->injection.column_rule == SONJECT_COLUMNS_FOCUSED)
        strips->grid.strips = mean_strips(strips->first_hits, last_hits);
}

/* Chooses the quanta. Paths may gather much of a wide tube in one cell, so quanta leave seven
 * powers of ten over what a plane face's cell brings. */
static void choose_quanta(struct fan_record *fan)
{
    const double cell =
        (double)fan->strip_width / fan->strata * fan->elevation_step * 2.0 * fan->reference_range;
    fan->quanta = power_of_two_below(ldexp(1.0, 28) / (cell * fan->inverse_wavelength));
}

static void multibounce_record_init(struct multibounce_record *record, const struct tracer *tracer,
                                    const struct image_pair *pair)
{
    const sonject_injection_params *injection = &tracer->scene->injection;
    double height;
    const sonject_material_params *seabed;
    memset(record, 0, sizeof *record);
    record->interactions =
        (int32_t)(injection->interactions - pair->outgoing->bounces - pair->returning->bounces);
    record->is_focused = injection->column_rule == SONJECT_COLUMNS_FOCUSED;
    if (scene_boundary(tracer->scene, BOUNDARY_SEABED, &height, &seabed))
        surface_record_init(&record->seabed, seabed, tracer->view.wavelength_m);
}

static sonject_status begin_launch(struct multibounce_launch *of_pair, struct tracer *tracer,
                                   uint32_t part)
{
    const struct part_list parts = all_parts(tracer);
    struct launch *launch = &of_pair->launch;
    sonject_status status =
        launch_begin(launch, tracer, PROGRAM_TRACE_MULTIBOUNCE, "trace_multibounce");
    THEN(status, launch_add_objects(launch, tracer, &parts, tracer->placements[part].centre, NULL));
    THEN(status,
         launch_add(launch, tracer, LAUNCH_PAIR, sizeof of_pair->sources, &of_pair->sources));
    THEN(status,
         launch_add(launch, tracer, LAUNCH_MULTIBOUNCE, sizeof of_pair->record, &of_pair->record));
    THEN(status, buffer_reserve(tracer->report, tracer->device,
                                of_pair->capacity * sizeof(struct multibounce_echo_record),
                                &launch->buffers[LAUNCH_ECHOES]));
    THEN(status, launch_add(launch, tracer, LAUNCH_LISTED, sizeof(uint32_t), NULL));
    return status;
}

/* Chooses the number of sub-strips of a launch so that all their rays may echo at every hit. */
static void choose_chunk(struct multibounce_launch *of_pair,
                         const struct multibounce_strips *of_part)
{
    const struct fan_record *fan = &of_pair->launch.fan;
    const size_t a_strip =
        (size_t)fan->rays * fan->strata * (size_t)(of_pair->record.interactions - 1);
    const size_t strips = (size_t)of_part->first_hits.count;
    const size_t fitting = ECHOES_A_LAUNCH / a_strip;
    of_pair->chunk = (int32_t)(fitting < 1 ? 1 : fitting < strips ? fitting : strips);
    of_pair->capacity = (size_t)of_pair->chunk * a_strip;
}

sonject_status multibounce_launch_begin(struct multibounce_launch *of_pair, struct line_grid *grid,
                                        const struct multibounce_strips *of_part,
                                        struct tracer *tracer, uint32_t part,
                                        const struct image_pair *pair)
{
    struct fan_record *fan = &of_pair->launch.fan;
    memset(of_pair, 0, sizeof *of_pair);
    *grid = of_part->grid;
    grid->bins = multibounce_pair_bins(tracer, part, pair, grid, ANY_OBJECT);
    if (grid->bins.count == 0)
        return SONJECT_OK;
    multibounce_record_init(&of_pair->record, tracer, pair);
    sonject_status status =
        image_pair_aim(fan, &of_pair->sources, &of_pair->launch.rays, tracer, part, pair, grid);
    fan->stream = STREAM_MULTIBOUNCE_RAYS + STREAMS_OF_PAIR * pair->number + part;
    glint_fan_init(
        fan, tracer, part, &pair->outgoing->path,
        glint_cell_of(tracer, GLINT_CELL_WAVELENGTHS / multibounce_rays_finer(tracer, part)), 0.0);
    choose_quanta(fan);
    choose_chunk(of_pair, of_part);
    THEN(status, begin_launch(of_pair, tracer, part));
    if (status != SONJECT_OK)
        multibounce_launch_end(of_pair);
    return status;
}

void multibounce_launch_end(struct multibounce_launch *of_pair)
{
    launch_end(&of_pair->launch);
}

sonject_status multibounce_launch_strips(struct multibounce_launch *of_pair, struct tracer *tracer,
                                         struct span strips, struct multibounce_sums *sums)
{
    struct report *report = tracer->report;
    struct device *device = tracer->device;
    const device_buffer *buffers = of_pair->launch.buffers;
    uint32_t listed = 0;
    const void *mapped;
    of_pair->launch.fan.first_strip = strips.first;
    of_pair->launch.fan.strips = strips.count;
    CHECK(buffer_clear(report, device, buffers[LAUNCH_LISTED], sizeof listed));
    CHECK(launch_run(&of_pair->launch, tracer));
    CHECK(buffer_read(report, device, buffers[LAUNCH_LISTED], 0, sizeof listed, &listed));
    if (listed == 0)
        return SONJECT_OK;
    CHECK(buffer_map(report, device, buffers[LAUNCH_ECHOES],
                     listed * sizeof(struct multibounce_echo_record), &mapped));
    const bool is_added = multibounce_sums_add(sums, mapped, listed);
    buffer_unmap(device, buffers[LAUNCH_ECHOES], mapped);
    CHECK_MEMORY(report, is_added, "multi-bounce echoes");
    return SONJECT_OK;
}

static sonject_status trace_pair(struct multibounce_sums *sums, struct multibounce_launch *of_pair,
                                 const struct multibounce_strips *of_part, struct tracer *tracer,
                                 const struct line_grid *grid)
{
    const double ratio = tracer->view.range_ratio;
    const struct span all = of_part->first_hits;
    CHECK_MEMORY(tracer->report, multibounce_sums_init(sums, grid), "multi-bounce echoes");
    sums->amplitude_of_quantum = ratio * ratio / of_pair->launch.fan.quanta;
    for (int32_t done = 0; done < all.count; done += of_pair->chunk) {
        const int32_t left = all.count - done;
        const struct span strips = {all.first + done,
                                    left < of_pair->chunk ? left : of_pair->chunk};
        CHECK(multibounce_launch_strips(of_pair, tracer, strips, sums));
    }
    return multibounce_sums_share(sums, tracer->checkpoint);
}

static sonject_status trace_pairs(struct multibounce *multibounce, struct tracer *tracer,
                                  uint32_t part)
{
    struct multibounce_strips of_part;
    struct image_pairs pairs;
    struct image_pair pair;
    struct multibounce_launch of_pair;
    struct line_grid grid;
    multibounce_strips_init(&of_part, tracer, part);
    image_pairs_begin(&pairs, tracer, part, true, 2);
    while (image_pairs_next(&pairs, &pair)) {
        CHECK(multibounce_launch_begin(&of_pair, &grid, &of_part, tracer, part, &pair));
        if (grid.bins.count == 0)
            continue;
        multibounce->grid = grid;
        const sonject_status status =
            trace_pair(&multibounce->sums[multibounce->count++], &of_pair, &of_part, tracer, &grid);
        multibounce_launch_end(&of_pair);
        CHECK(status);
    }
    return SONJECT_OK;
}

sonject_status multibounce_begin(struct multibounce *multibounce, struct tracer *tracer,
                                 uint32_t object)
{
    const struct placed_object *placed = &tracer->objects[object];
    memset(multibounce, 0, sizeof *multibounce);
    multibounce->sums =
        allocate_array((size_t)placed->part_count * PAIRS_MAX, sizeof *multibounce->sums);
    CHECK_MEMORY(tracer->report, multibounce->sums, "multi-bounce echoes");
    sonject_status status = SONJECT_OK;
    for (uint32_t k = 0; status == SONJECT_OK && k < placed->part_count; k++)
        if (multibounce_may_echo(tracer, placed->first_part + k))
            status = trace_pairs(multibounce, tracer, placed->first_part + k);
    THEN(status, multibounce_find_regions(multibounce, tracer->report));
    if (status != SONJECT_OK)
        multibounce_end(multibounce);
    return status;
}

void multibounce_end(struct multibounce *multibounce)
{
    for (size_t i = 0; i < multibounce->count; i++)
        multibounce_sums_clear(&multibounce->sums[i]);
    free(multibounce->sums);
    free(multibounce->regions);
    memset(multibounce, 0, sizeof *multibounce);
}
