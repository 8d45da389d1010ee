/* What both parts of the tracer share: the patch, the placed objects and the counts. */
#ifndef SONJECT_TRACE_TRACER_H
#define SONJECT_TRACE_TRACER_H

#include <stdint.h>

#include "base/report.h"
#include "device/device.h"
#include "kernels/layout.h"
#include "scene/line_grid.h"
#include "scene/patch_view.h"
#include "scene/placement.h"
#include "scene/point_response.h"
#include "scene/scene.h"
#include "trace/ray_table.h"

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
    struct trace_counts counts;
    struct checkpoint *checkpoint; /* NULL: everything is traced, and nothing kept */
};

/* A fan record for a frame centred on a point of the view (x, horizontal range, height). Fills what
 * depends on frame, grid, sonar and seed; rays, quanta and stream are left 0. */
void fan_record_init(struct fan_record *fan, const struct tracer *tracer, const double origin[3],
                     const struct line_grid *grid);

/* The record of one part in a frame; its tile left 0. */
void object_record_init(struct object_record *record, const struct tracer *tracer, uint32_t part,
                        const double origin[3]);

/* Object records in a frame; tiles left 0. count = part_count. */
void object_records_init(struct object_record *records, const struct tracer *tracer,
                         const double origin[3]);

/* Heights that the seabed keeps to, m; both 0 where it is a plane. */
double tracer_lowest_seabed(const struct tracer *tracer);
double tracer_highest_seabed(const struct tracer *tracer);

/* The variant of programs that the scene needs: bits of enum program_variant. */
uint32_t tracer_variant(const struct tracer *tracer);

/* The record of a material whose lambert is a number. */
void surface_record_init(struct surface_record *record, const sonject_material_params *material,
                         double wavelength_m);

/* The most that a rough part scatters: f at normal incidence and mirror direction. */
double material_brightness(const sonject_material_params *material);

/* The most that an object's rough part scatters, at least Lambert's 1/pi: tallies are scaled by it.
 */
double brightest_scattering(const struct tracer *tracer);

/* Runs a trace kernel over the fan's strips, or those of them that are the checkpoint's, and adds
 * up what the work-items report. Arguments: the fan and its rays first, then `buffers`, then the
 * outcomes. Sets the fan's segments and turns. Errors: DEVICE (also faults that the kernel
 * reports), MEMORY.
 */
sonject_status trace_launch(struct tracer *tracer, device_kernel kernel, struct fan_record *fan,
                            const struct ray_table *rays, const device_buffer *buffers,
                            size_t buffer_count);

/* A kernel of the scene, to be given to kernel_release; NULL where checkpoints are added up and
 * nothing is traced. Errors: as kernel_create. */
sonject_status trace_kernel_create(struct tracer *tracer, uint32_t variant,
                                   enum device_program program, const char *name,
                                   device_kernel *kernel);

/* What both parts keep on the device. */
struct trace_device {
    device_kernel kernel;
    device_buffer objects, tallies;
    size_t tally_strips; /* that the tallies have room for */
};

/* The parts that a launch knows, in the order of its records. */
struct part_list {
    const uint32_t *numbers; /* of the scene's parts; NULL: 0, 1, 2... */
    uint32_t count;
};

/* Creates the kernel, the objects' buffer and tallies for as many of `strips` strips, of `elements`
 * 64-bit integers each, as fit 64 MB (at least one). On failure nothing is held. Errors: DEVICE,
 * MEMORY. */
sonject_status trace_device_init(struct trace_device *device, struct tracer *tracer,
                                 enum device_program program, const char *kernel_name,
                                 struct object_record *records, struct part_list parts,
                                 size_t strips, size_t elements);
void trace_device_clear(struct trace_device *device);

/* The largest power of two not above value; value > 0. */
float power_of_two_below(double value);

#endif
