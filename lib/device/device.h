/* Devices: which there are, one that is open, its buffers, and kernels that run on it. The device
 * "native" runs what the C compiler made of the kernels (native/), OpenCL all others (opencl/);
 * nothing outside this folder knows which. */
#ifndef SONJECT_DEVICE_DEVICE_H
#define SONJECT_DEVICE_DEVICE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <sonject/context.h>

#include "base/report.h"

/* What they point to is the device's. */
typedef void *device_buffer, *device_kernel;

struct device_calls;

struct device {
    const struct device_calls *calls; /* backend.h */
    bool is_cpu;
    uint32_t width;       /* lanes that the kernels are compiled for */
    uint32_t group_items; /* that trace a segment together (kernels/group.h) */
    uint32_t compute_units;
    size_t allocation_limit; /* bytes of one buffer */
    char name[128];
    char platform[128];
    char driver[128];

    /* native's: a host's threads; NULL: the library's own */
    sonject_run_tasks_function run_tasks;
    void *run_tasks_user;

    /* OpenCL's */
    bool is_pocl;
    struct _cl_device_id *id;
    struct shared_device *shared; /* with all contexts of the device */
    struct _cl_context *context;  /* its */
    struct _cl_command_queue *queue;
    struct _cl_kernel *fresh; /* of a program just built, not launched yet; NULL: none */
};

/* Names of all devices, the default one marked: see sonject_devices. Errors: DEVICE, MEMORY. */
sonject_status device_list(struct report *report, sonject_device_info *devices, size_t capacity,
                           size_t *count);

/* Opens the device that the parameters name, else the environment's SONJECT_DEVICE, else the
 * default: the first GPU of OpenCL, else native. Errors: DEVICE, MEMORY. On failure *device is
 * NULL.
 */
sonject_status device_open(struct report *report, const sonject_context_params *params,
                           struct device **device);
void device_close(struct device **device);

/* A device that is opened when it is first needed: all zeros but for the parameters, whose strings
 * must outlive it. */
struct device_slot {
    sonject_context_params params;
    struct device *device; /* NULL until then */
};

/* The device for a call. Errors: as device_open, and DEVICE in a forked child that may not use it.
 */
sonject_status device_slot_open(struct report *report, struct device_slot *slot,
                                struct device **device);
void device_slot_close(struct device_slot *slot);

/* A driver's threads do not come along into a forked child, whose calls would wait for them for
 * ever: refuses in a child of a process that used the driver. Errors: DEVICE. */
sonject_status driver_claim(struct report *report);

/* A buffer of bytes (at least 1), filled from contents, or with zeros if contents is NULL. To be
 * given to buffer_release. Errors: DEVICE, MEMORY. */
sonject_status buffer_create(struct report *report, struct device *device, size_t bytes,
                             const void *contents, device_buffer *buffer);

/* A buffer likewise, whose contents are undefined until they are written. */
sonject_status buffer_reserve(struct report *report, struct device *device, size_t bytes,
                              device_buffer *buffer);

/* Nothing where it is NULL, which it becomes. */
void buffer_release(struct device *device, device_buffer *buffer);

/* Copies between host and buffer; both wait until it is done. Errors: DEVICE, MEMORY. */
sonject_status buffer_read(struct report *report, struct device *device, device_buffer buffer,
                           size_t offset, size_t bytes, void *contents);
sonject_status buffer_write(struct report *report, struct device *device, device_buffer buffer,
                            size_t offset, size_t bytes, const void *contents);

/* Makes a buffer's first bytes readable where they lie (on a CPU without a copy); *contents is
 * valid until buffer_unmap. Errors: DEVICE, MEMORY. */
sonject_status buffer_map(struct report *report, struct device *device, device_buffer buffer,
                          size_t bytes, const void **contents);
void buffer_unmap(struct device *device, device_buffer buffer, const void *contents);

sonject_status buffer_clear(struct report *report, struct device *device, device_buffer buffer,
                            size_t bytes);

struct kernel_argument {
    size_t bytes;
    const void *value;
};

#define ARGUMENT(variable)                                                                         \
    {                                                                                              \
        sizeof(variable), &(variable)                                                              \
    }

/* Runs the kernel over global[0] x global[1] x global[2] work-items (1...3 dimensions), after all
 * that was asked of the device before, and waits for it. Errors: DEVICE, MEMORY. */
sonject_status kernel_run(struct report *report, struct device *device, device_kernel kernel,
                          const struct kernel_argument *arguments, size_t argument_count,
                          uint32_t dimensions, const size_t *global);

/* Nothing where it is NULL, which it becomes. */
void kernel_release(struct device *device, device_kernel *kernel);

enum device_program {
    PROGRAM_TRACE_ROUGH,
    PROGRAM_TRACE_ROUGH_IMAGES,
    PROGRAM_TRACE_SMOOTH,
    PROGRAM_TRACE_SMOOTH_IMAGES,
    PROGRAM_TRACE_CHAINS,
    PROGRAM_TRACE_MULTIBOUNCE,
    PROGRAM_IMAGE_FORMATION,
    PROGRAM_ELEMENT_SERIES,
    PROGRAM_COUNT
};

/* Each program is built in two ways: see kernels/layout.h. */
enum program_variant {
    PROGRAM_PLAIN, /* without meshes, relief, fouling and slices, as most scenes are */
    PROGRAM_FULL
};

/* The kernels' sources, flattened at build time (opencl/embed.py) so that no file is needed at run
 * time. */
struct embedded_source {
    const char *name;
    const char *text; /* terminated */
    size_t bytes;     /* without the terminator */
};

/* In the order of enum device_program. */
extern const struct embedded_source embedded_sources[];

/* A kernel of a program, to be given to kernel_release; NULL on failure. OpenCL builds the program
 * once a device for all contexts of a process; what of it is kept between processes is the driver's
 * to say. Errors: DEVICE (with the first line of the build log), MEMORY. */
sonject_status kernel_create(struct report *report, struct device *device,
                             enum device_program program, enum program_variant variant,
                             const char *name, device_kernel *kernel);

#endif
