/* Buffers and launches. All on the device's in-order queue. */
#ifndef SONJECT_CL_LAUNCH_H
#define SONJECT_CL_LAUNCH_H

#include "cl/device.h"

/* A buffer of bytes (at least 1), filled from contents, or with zeros if contents is NULL. To be
 * given to buffer_release. Errors: DEVICE, MEMORY. */
sonject_status buffer_create(struct report *report, struct device *device, size_t bytes,
                             const void *contents, cl_mem *buffer);
void buffer_release(cl_mem *buffer);

/* Copies between host and buffer; both wait until it is done. Errors: DEVICE, MEMORY. */
sonject_status buffer_read(struct report *report, struct device *device, cl_mem buffer,
                           size_t offset, size_t bytes, void *contents);
sonject_status buffer_write(struct report *report, struct device *device, cl_mem buffer,
                            size_t offset, size_t bytes, const void *contents);
/* Makes a buffer's first bytes readable where they lie (on a CPU without a copy); *contents is
 * valid until buffer_unmap. Errors: DEVICE, MEMORY. */
sonject_status buffer_map(struct report *report, struct device *device, cl_mem buffer, size_t bytes,
                          const void **contents);
void buffer_unmap(struct device *device, cl_mem buffer, const void *contents);

sonject_status buffer_clear(struct report *report, struct device *device, cl_mem buffer,
                            size_t bytes);

struct kernel_argument {
    size_t bytes;
    const void *value;
};

#define ARGUMENT(variable)                                                                         \
    {                                                                                              \
        sizeof(variable), &(variable)                                                              \
    }

/* Runs the kernel over global[0] x global[1] x global[2] work-items (1...3 dimensions) and waits
 * for it. Errors: DEVICE, MEMORY. */
sonject_status kernel_run(struct report *report, struct device *device, cl_kernel kernel,
                          const struct kernel_argument *arguments, size_t argument_count,
                          uint32_t dimensions, const size_t *global);

#endif
