/* Devices: their list, an open device, its buffers, and kernels that run on it. The device "native"
 * runs kernels that the C compiler built (native/); all others are OpenCL's (opencl/). Code outside
 * this folder does not know which. */
#ifndef SONJECT_DEVICE_DEVICE_H
#define SONJECT_DEVICE_DEVICE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <sonject/context.h>

#include "base/report.h"

/* Pointers to what the device owns. */
typedef void *device_buffer, *device_kernel;

struct device_calls;

struct device {
    const struct device_calls *calls; /* see backend.h */
    bool is_cpu;
    uint32_t width;       /* lanes that the kernels are compiled for */
    uint32_t group_items; /* work-items that trace a segment together (kernels/group.h) */
    uint32_t compute_units;
    size_t allocation_limit; /* bytes of the largest buffer */
    char name[128];
    char platform[128];
    char driver[128];

    /* native: a host's threads; NULL: the library's own */
    sonject_run_tasks_function run_tasks;
    void *run_tasks_user;

    /* OpenCL */
    bool is_pocl;
    struct _cl_device_id *id;
    struct shared_device *shared; /* shared with all contexts of the device */
    struct _cl_context *context;  /* shared->context */
    struct _cl_command_queue *queue;
    struct _cl_kernel *fresh; /* kernel just built, not yet launched; NULL: none */
};

/* Lists all devices and marks the default one: see sonject_devices. Always returns SONJECT_OK;
 * failures of OpenCL are noted in the log. */
sonject_status device_list(struct report *report, sonject_device_info *devices, size_t capacity,
                           size_t *count);

/* Opens the device that params names, else the environment's SONJECT_DEVICE, else the default: the
 * first GPU of OpenCL, else native. Errors: DEVICE, MEMORY. On failure *device is NULL. */
sonject_status device_open(struct report *report, const sonject_context_params *params,
                           struct device **device);
void device_close(struct device **device);

/* A device that is opened when first needed. At the start all is zero except the parameters, whose
 * strings must outlive the slot. */
struct device_slot {
    sonject_context_params params;
    struct device *device; /* NULL: not opened yet */
};

/* Gives the device for a call, opened if need be. Errors: those of device_open; DEVICE in a forked
 * child that may not use the device. */
sonject_status device_slot_open(struct report *report, struct device_slot *slot,
                                struct device **device);
void device_slot_close(struct device_slot *slot);

/* Claims OpenCL's driver. Refuses in a child forked from a process that used the driver: the child
 * lacks the driver's threads, so its calls would wait for them for ever. Errors: DEVICE. */
sonject_status driver_claim(struct report *report);

/* Makes a buffer of bytes (at least 1), filled from contents, or with zeros if contents is NULL.
 * For buffer_release. Errors: DEVICE, MEMORY. */
sonject_status buffer_create(struct report *report, struct device *device, size_t bytes,
                             const void *contents, device_buffer *buffer);

/* Makes a buffer with undefined contents. For buffer_release. Errors: DEVICE, MEMORY. */
sonject_status buffer_reserve(struct report *report, struct device *device, size_t bytes,
                              device_buffer *buffer);

/* Releases *buffer, unless NULL, and sets it to NULL. */
void buffer_release(struct device *device, device_buffer *buffer);

/* Copies between host and buffer, and waits until that is done. Errors: DEVICE, MEMORY. */
sonject_status buffer_read(struct report *report, struct device *device, device_buffer buffer,
                           size_t offset, size_t bytes, void *contents);
sonject_status buffer_write(struct report *report, struct device *device, device_buffer buffer,
                            size_t offset, size_t bytes, const void *contents);

/* Makes a buffer's first bytes readable in place (on a CPU without a copy). *contents is valid
 * until buffer_unmap. Errors: DEVICE, MEMORY. */
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
 * earlier work of the device, and waits for the end. Errors: DEVICE, MEMORY, CANCELLED. */
sonject_status kernel_run(struct report *report, struct device *device, device_kernel kernel,
                          const struct kernel_argument *arguments, size_t argument_count,
                          uint32_t dimensions, const size_t *global);

/* Releases *kernel, unless NULL, and sets it to NULL. */
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

/* The two ways in which each program is built: see kernels/layout.h. */
enum program_variant {
    PROGRAM_PLAIN, /* without meshes, relief, fouling and slices, for most scenes */
    PROGRAM_FULL
};

/* A source of kernels, flattened at build time (opencl/embed.py); no file is needed at run time. */
struct embedded_source {
    const char *name;
    const char *text; /* terminated */
    size_t bytes;     /* without the terminator */
};

/* The sources, in the order of enum device_program. */
extern const struct embedded_source embedded_sources[];

/* Makes a kernel of a program, for kernel_release; NULL on failure. OpenCL builds the program once
 * per device for all contexts of a process; the driver decides what is kept between processes.
 * Errors: DEVICE (with the first line of the build log), MEMORY, CANCELLED. */
sonject_status kernel_create(struct report *report, struct device *device,
                             enum device_program program, enum program_variant variant,
                             const char *name, device_kernel *kernel);

#endif
