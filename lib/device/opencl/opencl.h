/* OpenCL for this folder's files, and what a process has one of: the driver, and for each device in
 * use the context and the programs. */
#ifndef SONJECT_DEVICE_OPENCL_OPENCL_H
#define SONJECT_DEVICE_OPENCL_OPENCL_H

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <CL/cl_ext.h>

#include "device/backend.h"

/* More than all programs of a device, at several widths. */
#define PROGRAMS_KEPT    64
#define OPTIONS_CAPACITY 128

struct kept_program {
    cl_program program;
    const struct embedded_source *source;
    char options[OPTIONS_CAPACITY];
};

/* The part of a device that contexts share. Only for use between driver_enter and driver_leave. */
struct shared_device {
    struct shared_device *next;
    size_t users;
    cl_device_id id;
    cl_context context;
    size_t program_count;
    struct kept_program programs[PROGRAMS_KEPT];
};

/* Claims the driver and locks it until driver_leave: drivers search for devices again in each
 * thread that asks first. No function of the caller's may be called in between. Errors: DEVICE. */
sonject_status driver_enter(struct report *report);
void driver_leave(void);

/* Returns a name such as "CL_OUT_OF_RESOURCES". */
const char *opencl_error_name(cl_int error);

/* Returns SONJECT_OK or, if the OpenCL call failed, SONJECT_ERROR_DEVICE (MEMORY if the host is out
 * of memory) with a message that names the call and the error. */
sonject_status opencl_answer(struct report *report, const struct device *device, const char *call,
                             cl_int error);

/* Calls compile(user), and tells the progress if that takes long. Errors: CANCELLED, but only after
 * compile has returned. */
sonject_status wait_for_compiler(struct report *report, void (*compile)(void *user), void *user);

/* The functions of an open device (launch.c), and those that other files define. */
extern const struct device_calls opencl_calls;
void opencl_close(struct device *device);
sonject_status opencl_kernel_create(struct report *report, struct device *device,
                                    enum device_program program, enum program_variant variant,
                                    const char *name, device_kernel *kernel);

#endif
