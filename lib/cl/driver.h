/* What a process has one of: the OpenCL driver, and of each device in use its context and programs.
 */
#ifndef SONJECT_CL_DRIVER_H
#define SONJECT_CL_DRIVER_H

#include <stdbool.h>
#include <stddef.h>

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <CL/cl_ext.h>

#include "base/hash.h"
#include "base/report.h"

/* A driver's threads do not come along into a forked child, whose calls would wait for them for
 * ever: refuses in a child of a process that used the driver. Errors: DEVICE. */
sonject_status driver_claim(struct report *report);

/* Whether driver_claim refuses: then nothing of the driver may be released either. */
bool driver_is_inherited(void);

/* Claims the driver and locks it, until driver_leave: drivers find their devices anew in each
 * thread that asks first. Nothing of the caller's is to be called within. Errors: DEVICE. */
sonject_status driver_enter(struct report *report);
void driver_leave(void);

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

/* The device's record, made for its first user and released by its last. host_context: where a host
 * wants the work to be done, or NULL. */
struct shared_device *shared_device_find(cl_device_id id, cl_context host_context, cl_int *error);
void shared_device_release(struct shared_device *device);

/* NULL: there is none. The program stays the record's. */
cl_program shared_program_find(struct shared_device *device, const char *key);

/* Takes the program over; the one that was not used for longest may go. */
void shared_program_keep(struct shared_device *device, const char *key, cl_program program);

#endif
