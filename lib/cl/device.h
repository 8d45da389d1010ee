/* One OpenCL device with the kernels compiled for it. */
#ifndef SONJECT_CL_DEVICE_H
#define SONJECT_CL_DEVICE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <sonject/context.h>

#include "cl/driver.h"

enum device_program {
    PROGRAM_TRACE_ROUGH,
    PROGRAM_TRACE_ROUGH_MIRRORED,
    PROGRAM_TRACE_SMOOTH,
    PROGRAM_TRACE_SMOOTH_MIRRORED,
    PROGRAM_TRACE_CHAINS,
    PROGRAM_TRACE_CORNERS,
    PROGRAM_IMAGE_FORMATION,
    PROGRAM_ELEMENT_SERIES,
    PROGRAM_PROBE_USER_SHAPE, /* only with code of users */
    PROGRAM_COUNT
};

/* What a program is built with, bits: each takes its time to build, so most scenes do without. */
enum program_variant {
    PROGRAM_WITH_MESHES = 1,
    PROGRAM_WITH_RELIEF = 2,
    PROGRAM_WITH_ASPECTS = 4 /* the rough part's */
};

struct device {
    cl_device_id id;
    struct shared_device *shared; /* with all contexts of the device */
    cl_context context;           /* its */
    cl_command_queue queue;
    bool is_cpu;
    uint32_t width; /* lanes that the kernels are compiled for */
    uint32_t compute_units;
    size_t allocation_limit; /* bytes of one buffer */
    char name[128];
    char platform[128];
    char driver[128];
};

/* Names of all devices, the default one first marked: see sonject_devices. Errors: DEVICE, MEMORY.
 */
sonject_status device_list(struct report *report, sonject_device_info *devices, size_t capacity,
                           size_t *count);

/* Opens the device that the parameters name. Default: the first GPU, else the first CPU, else the
 * first of any kind. Errors: DEVICE, MEMORY. On failure *device is NULL. */
sonject_status device_open(struct report *report, const sonject_context_params *params,
                           struct device **device);
void device_close(struct device **device);

/* The message for a failed OpenCL call: its name and the error's. Returns SONJECT_ERROR_DEVICE, or
 * SONJECT_ERROR_MEMORY where the host is out of memory. */
sonject_status device_failure(struct report *report, const struct device *device, const char *call,
                              cl_int error);

/* "CL_OUT_OF_RESOURCES" and the like. */
const char *cl_error_name(cl_int error);

#endif
