/* Kernels: embedded sources, built once a device and kept in a cache. */
#ifndef SONJECT_CL_PROGRAM_H
#define SONJECT_CL_PROGRAM_H

#include "cl/device.h"

/* The program, built on first use. variant: bits of enum program_variant. Errors: DEVICE (with the
 * first line of the build log), MEMORY. */
sonject_status program_get(struct report *report, struct device *device,
                           enum device_program program, uint32_t variant, cl_program *out);

/* A kernel of the program, to be given to clReleaseKernel. Errors: as program_get. */
sonject_status kernel_create(struct report *report, struct device *device,
                             enum device_program program, uint32_t variant, const char *name,
                             cl_kernel *kernel);

#endif
