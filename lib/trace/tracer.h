/* What all traces share: the patch, the placed objects and the counts; and launches of a kernel
 * over a fan of rays. */
#ifndef SONJECT_TRACE_TRACER_H
#define SONJECT_TRACE_TRACER_H

#include <stdbool.h>
#include <stdint.h>

#include "base/report.h"
#include "device/device.h"
#include "kernels/layout.h"
#include "scene/patch_view.h"
#include "scene/placement.h"
#include "scene/point_response.h"
#include "scene/scene.h"

struct checkpoint;

struct trace_counts {
    uint64_t pings, rays, queries, impulses;
};

/* Borrowed by traces; must outlive them. */
struct tracer {
    struct report *report;
    struct device *device;
    const struct scene *scene;
    struct patch_view view;
    struct point_response response;
    const struct placement *placements; /* of all parts of objects: what rays meet */
    uint32_t part_count;
    const struct placed_object *objects; /* of scene->objects: where their parts are */
    const struct relief *relief;         /* NULL: the seabed is the plane */
    const bool *follows; /* of scene->objects: whose echoes the view is to show; the others are
                            only in the way. NULL: all */
    struct trace_counts counts;
    struct checkpoint *checkpoint; /* NULL: everything is traced, and nothing kept */
};

/* Whether echoes of that object are followed. */
static inline bool tracer_follows(const struct tracer *tracer, uint32_t object)
{
    return !tracer->follows || tracer->follows[object];
}

/* Heights that the seabed keeps to, m; both 0 where it is a plane. */
double tracer_lowest_seabed(const struct tracer *tracer);
double tracer_highest_seabed(const struct tracer *tracer);

/* A fan record for a frame centred on a point of the view (x, horizontal range, height). Fills what
 * depends on frame, grid, sonar and seed; rays, quanta and stream are left 0. */
void fan_record_init(struct fan_record *fan, const struct tracer *tracer, const double origin[3],
                     const struct line_grid *grid);

/* The record of a material whose lambert is a number. */
void surface_record_init(struct surface_record *record, const sonject_material_params *material,
                         double wavelength_m);

/* Whether the material has a specular part, and one that scatters: of what reflects, that is what
 * roughness takes from it. */
bool material_is_smooth(const sonject_material_params *material);
bool material_is_rough(const sonject_material_params *material);

/* The most that a rough part scatters: f at normal incidence and specular direction. */
double material_brightness(const sonject_material_params *material);

/* The largest power of two not above value; value > 0. */
float power_of_two_below(double value);

/* The pieces of all bent rays that a launch looks up; none where all are straight. */
struct ray_table {
    struct ray_piece_record *pieces; /* owned */
    size_t count;
};

#define LAUNCH_BUFFERS_MAX 5

/* A kernel and its arguments: the fan and its rays first, then the buffers, then what the groups
 * of work-items report. All that it holds is its own. */
struct launch {
    struct device *device; /* the tracer's */
    device_kernel kernel;  /* NULL where checkpoints are added up and nothing is traced */
    struct fan_record fan;
    struct ray_table rays;
    device_buffer buffers[LAUNCH_BUFFERS_MAX]; /* in the order in which they were added */
    size_t buffer_count;
};

/* Creates the kernel, in the variant that the scene needs. `launch`, zeros, its fan or its rays so
 * far, is to be given to launch_end also after a failure. Errors: as kernel_create. */
sonject_status launch_begin(struct launch *launch, struct tracer *tracer,
                            enum device_program program, const char *kernel_name);
void launch_end(struct launch *launch);

/* Adds a buffer: as buffer_create. */
sonject_status launch_add(struct launch *launch, struct tracer *tracer, size_t bytes,
                          const void *contents);

/* Adds tallies for as many of `strips` strips, of `elements` 64-bit integers each, as fit 16 MB (at
 * least one); *chunk tells how many. */
sonject_status launch_add_tallies(struct launch *launch, struct tracer *tracer, int32_t strips,
                                  size_t elements, int32_t *chunk);

/* Runs the kernel over the fan's strips, or those of them that are the checkpoint's, and adds up
 * what the groups report. Sets the fan's segments and turns. Errors: DEVICE (also faults that
 * the kernel reports), MEMORY. */
sonject_status launch_run(struct launch *launch, struct tracer *tracer);

/* Reads tallies that begin with element `first`, in the checkpoint's turn: element i of plane p is
 * tally i * plane_count + p, times `unit`. */
sonject_status tallies_read(struct tracer *tracer, device_buffer tallies, size_t first,
                            size_t count, double unit, size_t plane_count, float *const *planes);

#endif
