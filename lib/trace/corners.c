#include "trace/corners.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "device/device.h"
#include "trace/glints.h"

#define BINS_MAX           1.0e9 /* beyond any patch, within a 32-bit number */
#define FINER_MAX          2.0   /* 4 times the rays */
#define WIDEST_WAVELENGTHS 0.5   /* of a cell where it meets the next face */
#define ECHOES_A_LAUNCH    ((size_t)1 << 20)

static bool is_smooth(const struct tracer *tracer, uint32_t part)
{
    return material_is_smooth(tracer->placements[part].material);
}

bool corners_may_echo(const struct tracer *tracer, uint32_t part)
{
    const struct placement *placement = &tracer->placements[part];
    uint32_t smooth_parts = 0;
    for (uint32_t i = 0; i < tracer->part_count; i++)
        smooth_parts += is_smooth(tracer, i);
    return tracer->scene->injection.interactions >= 2 && is_smooth(tracer, part) &&
           (smooth_parts > 1 || !shape_is_convex(&placement->size, placement->shape));
}

void corner_pairs_begin(struct corner_pairs *pairs, const struct tracer *tracer, uint32_t part)
{
    const struct sound_source sonar = {tracer->view.water, 0, MIRROR_SEABED};
    pairs->sonar = sonar;
    pairs->has_begun = false;
    image_pairs_begin(&pairs->others, tracer, part);
}

const struct image_pair *corner_pairs_next(struct corner_pairs *pairs)
{
    const uint32_t interactions = pairs->others.tracer->scene->injection.interactions;
    if (!pairs->has_begun) {
        pairs->has_begun = true;
        pairs->pair.outgoing = pairs->pair.returning = &pairs->sonar;
        pairs->pair.number = 0;
        return &pairs->pair;
    }
    while (image_pairs_next(&pairs->others, &pairs->pair))
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
                                const struct image_pair *pair)
{
    const struct placement *first = &tracer->placements[part];
    const uint32_t interactions =
        tracer->scene->injection.interactions - pair->outgoing->bounces - pair->returning->bounces;
    const struct ranges out = ranges_of(pair->outgoing, first);
    struct ranges returned = {INFINITY, 0.0};
    double aside = 0.0;
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct placement *last = &tracer->placements[i];
        if (!is_smooth(tracer, i))
            continue;
        const struct ranges one = ranges_of(pair->returning, last);
        returned.nearest = fmin(returned.nearest, one.nearest);
        returned.farthest = fmax(returned.farthest, one.farthest);
        aside = fmax(aside, fabs(first->centre[0] - last->centre[0]) + first->bounding_radius_m +
                                last->bounding_radius_m);
    }
    /* the source stands beside both hits: each leg is longer by no more than aside^2 / 2 range */
    const double lengthened = aside * aside / fmax(fmin(out.nearest, returned.nearest), 1e-3);
    struct ranges half;
    half.nearest = 0.5 * (out.nearest + returned.nearest);
    half.farthest = 0.5 * (out.farthest + returned.farthest + lengthened +
                           (interactions - 1.0) * longest_step(tracer));
    return half;
}

/* Bins of the patch where a pair's echoes may lie; count 0 if there are none. Of the grid only the
 * size of its bins is used. */
static struct span corner_pair_bins(const struct tracer *tracer, uint32_t part,
                                    const struct image_pair *pair, const struct line_grid *grid)
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
    const struct image_pair *pair;
    struct span bins = {0, 0};
    if (!corners_may_echo(tracer, part))
        return bins;
    corner_pairs_begin(&pairs, tracer, part);
    while ((pair = corner_pairs_next(&pairs)) != NULL)
        bins = span_join(bins, corner_pair_bins(tracer, part, pair, grid));
    return bins;
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
static double corner_rays_finer(const struct tracer *tracer, uint32_t part)
{
    const double radius = tracer->placements[part].size.least_curvature_m;
    const double spread = 1.0 + 2.0 * farthest_middle(tracer, part) / radius;
    return fmin(fmax(spread * GLINT_CELL_WAVELENGTHS / WIDEST_WAVELENGTHS, 1.0), FINER_MAX);
}

/* In the sub-strips of first and last hits. */
static struct span mean_strips(struct span one, struct span other)
{
    struct span mean;
    mean.first = (int32_t)floor(0.5 * ((double)one.first + other.first)) - 1;
    mean.count = (int32_t)ceil(0.5 * ((double)one.first + one.count + other.first + other.count)) +
                 2 - mean.first;
    return mean;
}

void corners_init(struct corners *corners, const struct tracer *tracer, uint32_t part)
{
    struct line_grid other;
    glint_strips_init(&corners->grid, tracer, part);
    corners->grid.bins.first = corners->grid.bins.count = 0;
    corners->first_hits = corners->grid.strips;
    struct span last_hits = corners->grid.strips;
    for (uint32_t i = 0; i < tracer->part_count; i++)
        if (material_is_smooth(tracer->placements[i].material)) {
            glint_strips_init(&other, tracer, i);
            last_hits = span_join(last_hits, other.strips);
        }
    if (tracer->scene->injection.column_rule == SONJECT_COLUMNS_FOCUSED)
        corners->grid.strips = mean_strips(corners->first_hits, last_hits);
}

/* Paths may gather much of a wide tube in one cell, so quanta leave seven powers of ten over what a
 * plane mirror's cell brings. */
static void choose_quanta(struct fan_record *fan)
{
    const double cell =
        (double)fan->strip_width / fan->strata * fan->elevation_step * 2.0 * fan->reference_range;
    fan->quanta = power_of_two_below(ldexp(1.0, 28) / (cell * fan->inverse_wavelength));
}

static void corner_record_init(struct corner_record *record, const struct tracer *tracer,
                               const struct image_pair *pair)
{
    const sonject_injection_params *injection = &tracer->scene->injection;
    double height;
    const sonject_material_params *seabed;
    memset(record, 0, sizeof *record);
    record->interactions =
        (int32_t)(injection->interactions - pair->outgoing->bounces - pair->returning->bounces);
    record->is_focused = injection->column_rule == SONJECT_COLUMNS_FOCUSED;
    if (scene_mirror(tracer->scene, MIRROR_SEABED, &height, &seabed))
        surface_record_init(&record->seabed, seabed, tracer->view.wavelength_m);
}

static sonject_status begin_on_device(struct corner_launch *launch, struct tracer *tracer,
                                      const double origin[3])
{
    struct report *report = tracer->report;
    struct device *device = tracer->device;
    struct object_record *records = allocate_array(tracer->part_count, sizeof *records);
    CHECK_MEMORY(report, records, "objects");
    object_records_init(records, tracer, origin);
    sonject_status status =
        trace_device_init(&launch->on_device, tracer, PROGRAM_TRACE_CORNERS, "trace_corners",
                          records, (struct part_list){NULL, tracer->part_count}, 1, 1);
    free(records);
    THEN(status, buffer_create(report, device, sizeof launch->sources, &launch->sources,
                               &launch->source_buffer));
    THEN(status, buffer_create(report, device, sizeof launch->record, &launch->record,
                               &launch->record_buffer));
    THEN(status, buffer_create(report, device, sizeof(uint32_t), NULL, &launch->listed));
    THEN(status, buffer_create(report, device, launch->capacity * sizeof(struct corner_echo_record),
                               NULL, &launch->echoes));
    return status;
}

/* So many sub-strips that all their rays may echo at every hit. */
static void choose_chunk(struct corner_launch *launch, const struct corners *corners)
{
    const size_t a_strip =
        (size_t)launch->fan.rays * launch->fan.strata * (size_t)(launch->record.interactions - 1);
    const size_t strips = (size_t)corners->first_hits.count;
    const size_t fitting = ECHOES_A_LAUNCH / a_strip;
    launch->chunk = (int32_t)(fitting < 1 ? 1 : fitting < strips ? fitting : strips);
    launch->capacity = (size_t)launch->chunk * a_strip;
}

sonject_status corner_launch_begin(struct corner_launch *launch, struct line_grid *grid,
                                   const struct corners *corners, struct tracer *tracer,
                                   uint32_t part, const struct image_pair *pair)
{
    memset(launch, 0, sizeof *launch);
    *grid = corners->grid;
    grid->bins = corner_pair_bins(tracer, part, pair, grid);
    if (grid->bins.count == 0)
        return SONJECT_OK;
    corner_record_init(&launch->record, tracer, pair);
    sonject_status status =
        image_pair_aim(&launch->fan, &launch->sources, &launch->rays, tracer, part, pair, grid);
    launch->fan.stream = STREAM_CORNER_RAYS + STREAMS_OF_PAIR * pair->number + part;
    glint_fan_init(&launch->fan, tracer, part, &pair->outgoing->way,
                   corner_rays_finer(tracer, part));
    choose_quanta(&launch->fan);
    choose_chunk(launch, corners);
    THEN(status, begin_on_device(launch, tracer, tracer->placements[part].centre));
    if (status != SONJECT_OK)
        corner_launch_end(launch);
    return status;
}

void corner_launch_end(struct corner_launch *launch)
{
    trace_device_clear(&launch->on_device);
    ray_table_clear(&launch->rays);
    buffer_release(&launch->source_buffer);
    buffer_release(&launch->record_buffer);
    buffer_release(&launch->listed);
    buffer_release(&launch->echoes);
}

sonject_status corner_launch_strips(struct corner_launch *launch, struct tracer *tracer,
                                    struct span strips, struct corner_sums *sums)
{
    struct report *report = tracer->report;
    struct device *device = tracer->device;
    const device_buffer buffers[] = {launch->on_device.objects, launch->source_buffer,
                                     launch->record_buffer, launch->echoes, launch->listed};
    uint32_t listed = 0;
    const void *mapped;
    launch->fan.first_strip = strips.first;
    launch->fan.strips = strips.count;
    sonject_status status = buffer_clear(report, device, launch->listed, sizeof listed);
    THEN(status,
         trace_launch(tracer, launch->on_device.kernel, &launch->fan, &launch->rays, buffers, 5));
    THEN(status, buffer_read(report, device, launch->listed, 0, sizeof listed, &listed));
    if (status != SONJECT_OK || listed == 0)
        return status;
    CHECK(buffer_map(report, device, launch->echoes, listed * sizeof(struct corner_echo_record),
                     &mapped));
    if (!corner_sums_add(sums, mapped, listed))
        status = report_out_of_memory(report, "echoes of corners");
    buffer_unmap(device, launch->echoes, mapped);
    return status;
}

static sonject_status trace_pair(struct corner_trace *trace, struct corner_launch *launch,
                                 const struct corners *corners, struct tracer *tracer,
                                 const struct line_grid *grid)
{
    const double ratio = tracer->view.range_ratio;
    const struct span all = corners->first_hits;
    sonject_status status = SONJECT_OK;
    trace->amplitude_of_quantum = ratio * ratio / launch->fan.quanta;
    if (!corner_sums_init(&trace->sums, grid))
        return report_out_of_memory(tracer->report, "echoes of corners");
    for (int32_t done = 0; status == SONJECT_OK && done < all.count; done += launch->chunk) {
        const int32_t left = all.count - done;
        const struct span strips = {all.first + done, left < launch->chunk ? left : launch->chunk};
        status = corner_launch_strips(launch, tracer, strips, &trace->sums);
    }
    return status == SONJECT_OK ? corner_sums_share(&trace->sums, tracer->checkpoint) : status;
}

static sonject_status trace_pairs(struct corners *corners, struct tracer *tracer, uint32_t part)
{
    struct corner_pairs pairs;
    const struct image_pair *pair;
    struct corner_launch launch;
    struct line_grid grid;
    sonject_status status = SONJECT_OK;
    corner_pairs_begin(&pairs, tracer, part);
    while (status == SONJECT_OK && (pair = corner_pairs_next(&pairs)) != NULL) {
        status = corner_launch_begin(&launch, &grid, corners, tracer, part, pair);
        if (status != SONJECT_OK || grid.bins.count == 0)
            continue;
        status = trace_pair(&corners->traces[corners->count++], &launch, corners, tracer, &grid);
        corner_launch_end(&launch);
    }
    return status;
}

sonject_status corners_begin(struct corners *corners, struct tracer *tracer, uint32_t part)
{
    memset(corners, 0, sizeof *corners);
    if (!corners_may_echo(tracer, part))
        return SONJECT_OK;
    corners->traces = allocate_array(CORNER_PAIRS_MAX, sizeof *corners->traces);
    CHECK_MEMORY(tracer->report, corners->traces, "echoes of corners");
    corners_init(corners, tracer, part);
    const sonject_status status = trace_pairs(corners, tracer, part);
    if (status != SONJECT_OK) {
        corners_end(corners);
        return status;
    }
    corners->grid.strips.count = 0;
    for (size_t i = 0; i < corners->count; i++) {
        struct span strips, bins;
        corner_sums_extent(&corners->traces[i].sums, &strips, &bins);
        corners->grid.strips = span_join(corners->grid.strips, strips);
        corners->grid.bins = span_join(corners->grid.bins, bins);
    }
    return SONJECT_OK;
}

void corners_end(struct corners *corners)
{
    for (size_t i = 0; i < corners->count; i++)
        corner_sums_clear(&corners->traces[i].sums);
    free(corners->traces);
    memset(corners, 0, sizeof *corners);
}

void corners_add(const struct corners *corners, struct span strips, const struct line_grid *grid,
                 float *real_part, float *imaginary_part)
{
    for (size_t i = 0; i < corners->count; i++)
        corner_sums_read(&corners->traces[i].sums, corners->traces[i].amplitude_of_quantum, strips,
                         grid, real_part, imaginary_part);
}
