/* Kernels: embedded sources, with or without code of users linked to them, built once a device for
 * all contexts of a process. What of it is kept between processes is the driver's to say. */
#ifndef SONJECT_CL_PROGRAM_H
#define SONJECT_CL_PROGRAM_H

#include "cl/device.h"

#define PROGRAM_OPTIONS_CAPACITY 192
#define PROGRAM_UNITS_MAX        64

/* What a program is made of. */
struct program_text {
    const char *name;    /* of the embedded source */
    const char *source;  /* its text */
    const char *calls;   /* more behind it: what it calls of the units; NULL: nothing */
    const char *options; /* of program_options */
    char *const *units;  /* users' code that is linked to it, each a translation unit of its own */
    size_t unit_count;   /* at most PROGRAM_UNITS_MAX; 0: nothing is linked */
    /* Makes the message of a unit that does not compile from the compiler's log. */
    sonject_status (*explain)(struct report *report, const struct device *device, const void *user,
                              size_t unit, const char *log);
    const void *user; /* for explain */
};

/* The options for a device, and `more`, each with a space before it. */
void program_options(const struct device *device, uint32_t variant, const char *more,
                     char options[PROGRAM_OPTIONS_CAPACITY]);

/* A kernel of the program, which is built unless a context of the device has it, to be given to
 * clReleaseKernel; NULL on failure. Errors: DEVICE, MEMORY, those of text->explain. */
sonject_status kernel_of_text(struct report *report, struct device *device,
                              const struct program_text *text, const char *name, cl_kernel *kernel);

/* The same of one of the library's own programs. variant: bits of enum program_variant. Errors:
 * DEVICE (with the first line of the build log), MEMORY. */
sonject_status kernel_create(struct report *report, struct device *device,
                             enum device_program program, uint32_t variant, const char *name,
                             cl_kernel *kernel);

#endif
