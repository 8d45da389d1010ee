#include "trace/glints.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "scene/shapes/shape.h"
#include "trace/fan.h"
#include "trace/object_buffer.h"

#define STRIP_WAVELENGTHS      0.25 /* widest sub-strip; wider ones alias glints */
#define SMALL_WAVELENGTHS      2.0  /* parts of a smaller radius have few rays, and may have more */
#define SMALL_CELL_WAVELENGTHS (0.25 * GLINT_CELL_WAVELENGTHS)
/* The cell of a round part, in square roots of wavelength times radius of curvature: an eleventh of
 * its first Fresnel zone across the ray. Along the track it is half of that. */
#define CELL_OF_CURVATURE (1.0 / 16.0)
/* Columns this wide, in wavelengths, hold so much seabed that the noise of edges hides in it. */
#define EDGE_COLUMN_WAVELENGTHS (5.0 / 3.0)
/* EDGE_WAVELENGTHS limits the change of the whole path across a cell of a flat face. Faces seen so
 * flat that this takes more than EDGE_FINER_MOST times the usual rays return little, and have
 * coarser cells. The loss at edges is made up where half the path changes by at most EDGE_MADE_UP
 * wavelengths across a cell; beyond, that would be noise. */
#define EDGE_WAVELENGTHS   0.3
#define EDGE_MADE_UP       0.4f
#define EDGE_FINER_MOST    8.0
#define BINS_PER_DEVIATION 16.0 /* linear sharing between bins then errs by 5e-4 */
#define IMAGE_STRIPS       64   /* strips of a launch: there may be dozens of pairs at a time */

double glint_shortest_deviation(const struct line_grid *grid, double column_spacing_m)
{
    return BINS_PER_DEVIATION * column_spacing_m / grid->bins_per_pixel;
}

void glint_strips_init(struct line_grid *grid, const struct tracer *tracer, uint32_t part)
{
    static const double along[3] = {1.0, 0.0, 0.0};
    const struct patch_view *view = &tracer->view;
    const struct placement *placement = &tracer->placements[part];
    grid->strips_per_row =
        (uint32_t)ceil(view->row_spacing_m / (STRIP_WAVELENGTHS * view->wavelength_m) - 1e-9);
    grid->bins_per_pixel = (uint32_t)ceil(
        BINS_PER_DEVIATION * view->column_spacing_m / tracer->response.range_deviation_m - 1e-9);
    const double extent = placement_half_extent(placement, along);
    grid->strips =
        strips_between(tracer, grid, placement->centre[0] - extent, placement->centre[0] + extent);
}

struct glint_cell glint_cell_of(const struct tracer *tracer, double wavelengths)
{
    const double side =
        wavelengths * tracer->view.wavelength_m / sqrt(tracer->scene->injection.ray_scale);
    return (struct glint_cell){side, side};
}

/* Returns the cells of a part. The phase over a cell is that of the tangent plane, and a cell at an
 * edge counts all or nothing. This leaves noise in a pixel. Its energy grows as the cube of the
 * cell's side over the square of the wavelength. Over the seabed's energy it falls with the column
 * spacing, so cells may widen where columns are many wavelengths. The tangent plane's error grows
 * with the square of the cell over wavelength and radius of curvature. It alone counts where
 * nothing is flat. */
static struct glint_cell cell_of_part(const struct tracer *tracer, uint32_t part)
{
    const struct placement *placement = &tracer->placements[part];
    const double wavelength = tracer->view.wavelength_m;
    const double curvature_radius = placement->size.least_radius_of_curvature_m;
    if (placement->bounding_radius_m < SMALL_WAVELENGTHS * wavelength)
        return glint_cell_of(tracer, SMALL_CELL_WAVELENGTHS);
    const double columns = tracer->view.column_spacing_m / (EDGE_COLUMN_WAVELENGTHS * wavelength);
    struct glint_cell cell =
        glint_cell_of(tracer, GLINT_CELL_WAVELENGTHS * cbrt(fmax(columns, 1.0)));
    if (placement->size.flat || isinf(curvature_radius))
        return cell;
    const double round =
        glint_cell_of(tracer, CELL_OF_CURVATURE * sqrt(curvature_radius / wavelength)).across;
    cell.across = fmax(cell.across, round);
    cell.along = fmax(cell.along, 0.5 * round);
    return cell;
}

void glint_fan_init(struct fan_record *fan, const struct tracer *tracer, uint32_t part,
                    const struct ray_path *path, struct glint_cell cell, double steepest)
{
    const double for_edges =
        steepest > 0.0 ? EDGE_WAVELENGTHS * tracer->view.wavelength_m / steepest : INFINITY;
    const double finest = glint_cell_of(tracer, GLINT_CELL_WAVELENGTHS / EDGE_FINER_MOST).across;
    fan_aim_at_part(fan, tracer, part, path, fmax(fmin(cell.across, for_edges), finest));
    /* nothing is made up for what is round and needs no finer cells */
    const bool has_corners = tracer->placements[part].size.flat & (uint32_t)FLAT_WITH_CORNERS;
    fan->edge_across =
        for_edges < cell.across || (steepest > 0.0 && has_corners) ? EDGE_MADE_UP : 0.0f;
    fan->strata = (uint32_t)ceil(fan->strip_width / cell.along - 1e-6);
    fan->only_object = (int32_t)part;
}

/* The axes of a part as seen along the track, along the ray and across it. */
struct sight {
    double track[3], ray[3], across[3];
    double aspects; /* sine of the widest aspect that the image is made of */
};

static struct sight sight_of_part(const struct tracer *tracer, uint32_t part,
                                  const struct ray_path *path)
{
    const struct placement *placement = &tracer->placements[part];
    const double grazing = ray_path_direction(path, placement->centre[1], placement->centre[2]);
    struct sight sight;
    for (int i = 0; i < 3; i++) {
        const double *axis = placement->axes[i];
        sight.track[i] = axis[0];
        sight.ray[i] = axis[1] * cos(grazing) - axis[2] * sin(grazing);
        sight.across[i] = axis[1] * sin(grazing) + axis[2] * cos(grazing);
    }
    /* glints have the aspects of the along-track response itself, whatever rough surfaces have */
    sight.aspects = tracer->scene->sonar.kind == SONJECT_SONAR_REAL
                        ? beam_largest_sine(tracer)
                        : 0.25 * tracer->view.wavelength_m / tracer->response.resolution_m;
    return sight;
}

/* Returns whether an edge along an axis is heard: equally far from the sonar all along at one of
 * the aspects, up to the second zero of its directivity. half_m: half its length. */
static bool is_edge_heard(const struct sight *sight, uint32_t axis, double half_m,
                          double wavelength_m)
{
    return fabs(sight->ray[axis]) <=
           sight->aspects * fabs(sight->track[axis]) + 0.5 * wavelength_m / half_m;
}

/* Returns the gradient of the whole path across the ray, on a face that stands across an axis. */
static double face_gradient(const struct sight *sight, uint32_t axis)
{
    const double across = sight->across[axis];
    return across == 0.0 ? 0.0 : 2.0 * fabs(across / sight->ray[axis]);
}

/* Returns the steepest gradient of a part's flat faces with edges that are heard, or 0. */
static double steepest_face(const struct tracer *tracer, uint32_t part, const struct ray_path *path)
{
    const struct placement *placement = &tracer->placements[part];
    const struct shape_size *size = &placement->size;
    const double half[3] = {size->half_length_m, size->half_width_m, size->half_height_m};
    const double wavelength = tracer->view.wavelength_m;
    const struct sight sight = sight_of_part(tracer, part, path);
    double steepest = 0.0;
    for (uint32_t axis = 0; axis < 3; axis++) {
        const uint32_t next = (axis + 1) % 3, last = (axis + 2) % 3;
        if ((size->flat & ((uint32_t)FLAT_ALONG_X << axis)) &&
            (!(size->flat & (uint32_t)FLAT_WITH_CORNERS) ||
             is_edge_heard(&sight, next, half[next], wavelength) ||
             is_edge_heard(&sight, last, half[last], wavelength)))
            steepest = fmax(steepest, face_gradient(&sight, axis));
    }
    return steepest;
}

static void choose_quanta(struct smooth_trace *trace, const struct tracer *tracer)
{
    struct fan_record *fan = &trace->launch.fan;
    const double ratio = tracer->view.range_ratio;
    const double cell =
        (double)fan->strip_width / fan->strata * fan->elevation_step * 2.0 * fan->reference_range;
    const double most = cell * fan->inverse_wavelength;
    fan->quanta = power_of_two_below(ldexp(1.0, 36) / most);
    trace->amplitude_of_quantum = ratio * ratio / fan->quanta;
}

/* Begins a launch of the parts in the way, centred on the one aimed at. sources: or NULL. */
static sonject_status begin_launch(struct smooth_trace *trace, struct tracer *tracer, uint32_t part,
                                   const struct image_pair_record *sources)
{
    const int32_t most = sources ? IMAGE_STRIPS : INT32_MAX;
    const int32_t strips = trace->grid.strips.count < most ? trace->grid.strips.count : most;
    struct launch *launch = &trace->launch;
    struct part_list parts;
    sonject_status status = parts_in_way(&parts, tracer, part, &trace->grid, !sources);
    THEN(status,
         launch_begin(launch, tracer, sources ? PROGRAM_TRACE_SMOOTH_IMAGES : PROGRAM_TRACE_SMOOTH,
                      sources ? "trace_smooth_images" : "trace_smooth"));
    THEN(status, launch_add_objects(launch, tracer, &parts, tracer->placements[part].centre, NULL));
    THEN(status, launch_add_tallies(launch, tracer, strips, 2 * (size_t)trace->grid.bins.count,
                                    &trace->chunk));
    if (sources)
        THEN(status, launch_add(launch, tracer, LAUNCH_PAIR, sizeof *sources, sources));
    fan_set_parts(&launch->fan, tracer, &parts);
    part_list_clear(&parts);
    return status;
}

sonject_status smooth_trace_begin(struct smooth_trace *trace, struct tracer *tracer, uint32_t part,
                                  const struct image_pair *pair)
{
    const struct sound_source sonar = {tracer->view.water, 0, BOUNDARY_SEABED};
    const struct image_pair straight = {&sonar, &sonar, 0};
    struct fan_record *fan = &trace->launch.fan;
    struct image_pair_record sources;
    sonject_status status = SONJECT_OK;
    memset(trace, 0, sizeof *trace);
    if (!part_has_glints(tracer, part))
        return SONJECT_OK;
    glint_strips_init(&trace->grid, tracer, part);
    trace->grid.bins = pair ? image_pair_bins_in_patch(tracer, part, pair, &trace->grid)
                            : image_pair_bins(tracer, part, &straight, &trace->grid);
    if (trace->grid.bins.count == 0)
        return SONJECT_OK;
    if (pair) {
        status =
            image_pair_aim(fan, &sources, &trace->launch.rays, tracer, part, pair, &trace->grid);
        fan->stream = STREAM_IMAGE_RAYS + STREAMS_OF_PAIR * pair->number + part;
    } else {
        /* the frame is centred on the object: phases then keep their digits */
        fan_record_init(fan, tracer, tracer->placements[part].centre, &trace->grid);
        fan->stream = STREAM_SMOOTH_RAYS + part;
        status = part_rays_add(&trace->launch.rays, tracer, part, &sonar.path, &fan->table);
    }
    const struct ray_path *path = pair ? &pair->outgoing->path : &sonar.path;
    glint_fan_init(fan, tracer, part, path, cell_of_part(tracer, part),
                   steepest_face(tracer, part, path));
    /* cells begin up to half a cell off (cell_shift_of) */
    fan->first_elevation -= 0.5f * fan->elevation_step;
    fan->rays++;
    choose_quanta(trace, tracer);
    THEN(status, begin_launch(trace, tracer, part, pair ? &sources : NULL));
    if (status != SONJECT_OK)
        smooth_trace_end(trace);
    return status;
}

void smooth_trace_end(struct smooth_trace *trace)
{
    launch_end(&trace->launch);
}

sonject_status smooth_trace_strips(struct smooth_trace *trace, struct tracer *tracer,
                                   struct span strips, float *real_part, float *imaginary_part)
{
    const size_t count = (size_t)strips.count * (size_t)trace->grid.bins.count;
    device_buffer tallies = trace->launch.buffers[LAUNCH_TALLIES];
    trace->launch.fan.first_strip = strips.first;
    trace->launch.fan.strips = strips.count;
    CHECK(buffer_clear(tracer->report, tracer->device, tallies, 2 * count * sizeof(int64_t)));
    CHECK(launch_run(&trace->launch, tracer));
    return tallies_read(tracer, tallies, 0, count, trace->amplitude_of_quantum, 2,
                        (float *const[]){real_part, imaginary_part});
}

static sonject_status begin_images(struct glints *glints, struct tracer *tracer, uint32_t part)
{
    struct image_pairs pairs;
    struct image_pair pair;
    image_pairs_begin(&pairs, tracer, part, false, 1);
    while (image_pairs_next(&pairs, &pair)) {
        struct smooth_trace *trace = &glints->traces[glints->count];
        CHECK(smooth_trace_begin(trace, tracer, part, &pair));
        glints->grid.bins = span_join(glints->grid.bins, trace->grid.bins);
        glints->count += trace->grid.bins.count > 0;
    }
    return SONJECT_OK;
}

sonject_status glints_begin(struct glints *glints, struct tracer *tracer, uint32_t part)
{
    memset(glints, 0, sizeof *glints);
    glints->traces =
        allocate_array(1 + (size_t)SOURCES_MAX * (SOURCES_MAX + 1) / 2, sizeof *glints->traces);
    CHECK_MEMORY(tracer->report, glints->traces, "glints");
    sonject_status status = smooth_trace_begin(&glints->traces[0], tracer, part, NULL);
    if (status == SONJECT_OK) {
        glints->count = 1;
        glints->grid = glints->traces[0].grid;
        if (glints->grid.strips.count > 0)
            status = begin_images(glints, tracer, part);
    }
    if (status == SONJECT_OK) {
        glints->chunk = glints->traces[0].chunk;
        for (size_t i = 1; i < glints->count; i++)
            if (glints->traces[i].chunk < glints->chunk)
                glints->chunk = glints->traces[i].chunk;
        const size_t cells = (size_t)glints->chunk * (size_t)glints->grid.bins.count;
        glints->real_part = allocate_array(cells, sizeof(float));
        glints->imaginary_part = allocate_array(cells, sizeof(float));
        if (!glints->real_part || !glints->imaginary_part)
            status = report_out_of_memory(tracer->report, "glints");
    }
    if (status != SONJECT_OK)
        glints_end(glints);
    return status;
}

void glints_end(struct glints *glints)
{
    for (size_t i = 0; i < glints->count; i++)
        smooth_trace_end(&glints->traces[i]);
    free(glints->traces);
    free(glints->real_part);
    free(glints->imaginary_part);
    memset(glints, 0, sizeof *glints);
}

/* Adds the bins of one trace to those of the common grid, from a line of the planes on. */
static void add_bins(const struct glints *glints, const struct smooth_trace *trace, int32_t strips,
                     size_t first_line, float *real_part, float *imaginary_part)
{
    const size_t width = (size_t)trace->grid.bins.count;
    const size_t offset = (size_t)(trace->grid.bins.first - glints->grid.bins.first);
    for (size_t strip = 0; strip < (size_t)strips; strip++) {
        const size_t at = (first_line + strip) * (size_t)glints->grid.bins.count + offset;
        for (size_t bin = 0; bin < width; bin++) {
            real_part[at + bin] += glints->real_part[strip * width + bin];
            imaginary_part[at + bin] += glints->imaginary_part[strip * width + bin];
        }
    }
}

sonject_status glints_trace(struct glints *glints, struct tracer *tracer, struct span strips,
                            float *real_part, float *imaginary_part)
{
    const size_t bytes = (size_t)strips.count * (size_t)glints->grid.bins.count * sizeof *real_part;
    if (glints->count == 1)
        return smooth_trace_strips(&glints->traces[0], tracer, strips, real_part, imaginary_part);
    memset(real_part, 0, bytes);
    memset(imaginary_part, 0, bytes);
    for (size_t i = 0; i < glints->count; i++) {
        const struct span some = span_overlap(strips, glints->traces[i].grid.strips);
        if (some.count == 0)
            continue;
        CHECK(smooth_trace_strips(&glints->traces[i], tracer, some, glints->real_part,
                                  glints->imaginary_part));
        add_bins(glints, &glints->traces[i], some.count, (size_t)(some.first - strips.first),
                 real_part, imaginary_part);
    }
    return SONJECT_OK;
}
