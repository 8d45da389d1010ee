/* Kernels: embedded sources, with or without code of users behind them, built once a device and
 * kept in a cache. */
#ifndef SONJECT_CL_PROGRAM_H
#define SONJECT_CL_PROGRAM_H

#include "base/hash.h"
#include "cl/device.h"

#define PROGRAM_OPTIONS_CAPACITY 192

/* What a program is made of, one piece of text after the other. */
struct program_text {
    const char *name; /* for the log */
    const char *const *pieces;
    size_t count;
    const char *options; /* of program_options */
    /* Makes the message of a failed build from its log; NULL: that of the library's own kernels. */
    sonject_status (*explain)(struct report *report, const struct device *device,
                              const struct program_text *text, const char *log);
    const void *user; /* for explain */
};

/* The options for a device, and `more`, each with a space before it. */
void program_options(const struct device *device, uint32_t variant, const char *more,
                     char options[PROGRAM_OPTIONS_CAPACITY]);

/* Digits that stand for text, options and device. Errors: MEMORY. */
sonject_status program_key(struct report *report, const struct device *device,
                           const struct program_text *text, char key[HASH_TEXT_CAPACITY]);

/* The program from the cache, or else built and put there. key: of program_key. The program is the
 * caller's, for clReleaseProgram. Errors: DEVICE, MEMORY, those of text->explain. */
sonject_status program_make(struct report *report, struct device *device,
                            const struct program_text *text, const char *key, cl_program *out);

/* A kernel of a program, to be given to clReleaseKernel; NULL on failure. Errors: DEVICE. */
sonject_status program_kernel(struct report *report, const struct device *device,
                              cl_program program, const char *name, cl_kernel *kernel);

/* The program, built on first use. variant: bits of enum program_variant. Errors: DEVICE (with the
 * first line of the build log), MEMORY. */
sonject_status program_get(struct report *report, struct device *device,
                           enum device_program program, uint32_t variant, cl_program *out);

/* A kernel of the program, to be given to clReleaseKernel. Errors: as program_get. */
sonject_status kernel_create(struct report *report, struct device *device,
                             enum device_program program, uint32_t variant, const char *name,
                             cl_kernel *kernel);

#endif
