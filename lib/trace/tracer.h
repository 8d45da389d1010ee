/* The state that all traces share, and launches of a kernel over a fan of rays. */
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

/* A scene's patch, placed objects and counts. Traces borrow the tracer, which must outlive them. */
struct tracer {
    struct report *report;
    struct device *device;
    const struct scene *scene;
    struct patch_view view;
    struct point_response response;
    const struct placement *placements; /* all parts of objects, which rays meet */
    uint32_t part_count;
    const struct placed_object *objects; /* scene->objects: tell where their parts are */
    const struct relief *relief;         /* NULL: the seabed is the plane */
    const bool *follows; /* for each of scene->objects, whether the view shows its echoes; others
                            are only in the way. NULL: all shown */
    struct trace_counts counts;
    struct checkpoint *checkpoint; /* NULL: everything is traced, and nothing is kept */
};

/* Returns whether echoes of that object are followed. */
static inline bool tracer_follows(const struct tracer *tracer, uint32_t object)
{
    return !tracer->follows || tracer->follows[object];
}

/* Returns the least, or the largest, height of the seabed, m; both are 0 where it is a plane. */
double tracer_lowest_seabed(const struct tracer *tracer);
double tracer_highest_seabed(const struct tracer *tracer);

/* Fills in a fan record for a frame centred on a point of the view (x, horizontal range, height).
 * It sets what depends on frame, grid, sonar and seed. Rays, quanta and stream are left 0. */
void fan_record_init(struct fan_record *fan, const struct tracer *tracer, const double origin[3],
                     const struct line_grid *grid);

/* Fills in the record of a material whose lambert is a number. */
void surface_record_init(struct surface_record *record, const sonject_material_params *material,
                         double wavelength_m);

/* Returns whether the material has a specular part, or a scattering one. Where a material reflects,
 * the scattering part is what roughness takes from reflection. */
bool material_is_smooth(const sonject_material_params *material);
bool material_is_rough(const sonject_material_params *material);

/* Returns the most that a rough part scatters: f at normal incidence in the specular direction. */
double material_brightness(const sonject_material_params *material);

/* Returns the largest power of two not above value; value > 0. */
float power_of_two_below(double value);

/* The pieces of all bent rays that a launch looks up; none where all are straight. */
struct ray_table {
    struct ray_piece_record *pieces; /* owned */
    size_t count;
};

/* The buffers of a launch, in the order of TRACE_ARGUMENTS (kernels/trace.h). */
enum launch_buffer {
    LAUNCH_OBJECTS,
    LAUNCH_MAP,
    LAUNCH_EDGES,
    LAUNCH_PAIR,
    LAUNCH_CHAINS,
    LAUNCH_SPHERES,
    LAUNCH_MULTIBOUNCE,
    LAUNCH_TALLIES,
    LAUNCH_TILES,
    LAUNCH_ECHOES,
    LAUNCH_LISTED,
    LAUNCH_BUFFERS
};

/* A kernel and its arguments: the fan and its rays first, then the buffers, then the reports of the
 * groups of work-items. All that it holds is its own. */
struct launch {
    struct device *device; /* the tracer's; borrowed */
    device_kernel kernel;  /* NULL where checkpoints are added up and nothing is traced */
    struct fan_record fan;
    struct ray_table rays;
    device_buffer buffers[LAUNCH_BUFFERS]; /* NULL: the tracer does without */
};

/* Creates the kernel in the variant that the scene needs. `launch` is zeros except for its fan and
 * rays so far, and goes to launch_end also after a failure. Errors: as kernel_create. */
sonject_status launch_begin(struct launch *launch, struct tracer *tracer,
                            enum device_program program, const char *kernel_name);
void launch_end(struct launch *launch);

/* Makes one of the launch's buffers. Errors: as buffer_create. */
sonject_status launch_add(struct launch *launch, struct tracer *tracer, enum launch_buffer buffer,
                          size_t bytes, const void *contents);

/* Adds tallies for as many of `strips` strips as fit 16 MB (at least one), each of `elements`
 * 64-bit integers. Sets *chunk to the number of strips. */
sonject_status launch_add_tallies(struct launch *launch, struct tracer *tracer, int32_t strips,
                                  size_t elements, int32_t *chunk);

/* Runs the kernel over the fan's strips, or the checkpoint's part of them, and adds up what groups
 * report. Sets the fan's segments and turns. Errors: DEVICE (also faults in the kernel), MEMORY. */
sonject_status launch_run(struct launch *launch, struct tracer *tracer);

/* Reads tallies that begin with element `first`, and passes them through the checkpoint. Element i
 * of plane p is tally i * plane_count + p, times `unit`. */
sonject_status tallies_read(struct tracer *tracer, device_buffer tallies, size_t first,
                            size_t count, double unit, size_t plane_count, float *const *planes);

#endif
