/* Kernels that the C compiler built. native.py's files define them, lib/device/native runs them. */
#ifndef SONJECT_DEVICE_NATIVE_KERNEL_H
#define SONJECT_DEVICE_NATIVE_KERNEL_H

#include <stddef.h>

#include "device/device.h"

/* Runs work-items first...end - 1 of global[0] x global[1] x global[2]. */
typedef void native_function(const struct kernel_argument *arguments, const size_t *global,
                             size_t first, size_t end);

struct native_kernel {
    const char *name; /* NULL: the program's end */
    native_function *run;
};

/* A program of one instruction set: its kernels. */
typedef const struct native_kernel *native_program;

#endif
