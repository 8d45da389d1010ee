/* What this folder's files share: OpenCL, and what a process has one of: its driver, and of each
 * device in use the context and the programs. */
#ifndef SONJECT_DEVICE_OPENCL_OPENCL_H
#define SONJECT_DEVICE_OPENCL_OPENCL_H

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <CL/cl_ext.h>

#include "base/hash.h"
#include "device/backend.h"

/* All the library's own programs for a device, and those with code of users used last. */
#define PROGRAMS_KEPT 64

struct kept_program {
    cl_program program;
    char key[HASH_TEXT_CAPACITY];
};

/* What contexts share of a device. Only for use between driver_enter and driver_leave. */
struct shared_device {
    struct shared_device *next;
    size_t users;
    cl_device_id id;
    cl_context host_context; /* NULL: `context` is the library's own */
    cl_context context;
    size_t program_count;
    struct kept_program programs[PROGRAMS_KEPT]; /* the one used last first */
};

/* Claims the driver and locks it, until driver_leave: drivers find their devices anew in each
 * thread that asks first. Nothing of the caller's is to be called within. Errors: DEVICE. */
sonject_status driver_enter(struct report *report);
void driver_leave(void);

/* "CL_OUT_OF_RESOURCES" and the like. */
const char *opencl_error_name(cl_int error);

/* SONJECT_OK, or where the OpenCL call failed SONJECT_ERROR_DEVICE (MEMORY where the host is out of
 * memory) with a message that names it and the error. */
sonject_status opencl_answer(struct report *report, const struct device *device, const char *call,
                             cl_int error);

/* What struct device_calls asks for (launch.c, program.c). */
sonject_status opencl_reserve(struct report *report, struct device *device, size_t bytes,
                              device_buffer *buffer);
void opencl_release(device_buffer buffer);
sonject_status opencl_read(struct report *report, struct device *device, device_buffer buffer,
                           size_t offset, size_t bytes, void *contents);
sonject_status opencl_write(struct report *report, struct device *device, device_buffer buffer,
                            size_t offset, size_t bytes, const void *contents);
sonject_status opencl_map(struct report *report, struct device *device, device_buffer buffer,
                          size_t bytes, const void **contents);
void opencl_unmap(struct device *device, device_buffer buffer, const void *contents);
sonject_status opencl_clear(struct report *report, struct device *device, device_buffer buffer,
                            size_t bytes);
sonject_status opencl_kernel_create(struct report *report, struct device *device,
                                    enum device_program program, enum program_variant variant,
                                    const struct user_code *code, const char *name,
                                    device_kernel *kernel);
void opencl_kernel_release(device_kernel kernel);
sonject_status opencl_kernel_run(struct report *report, struct device *device, device_kernel kernel,
                                 const struct kernel_argument *arguments, size_t argument_count,
                                 uint32_t dimensions, const size_t *global);

#endif
