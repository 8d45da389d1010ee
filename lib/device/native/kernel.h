/* Kernels that the C compiler built: what native.py's files offer, and lib/device/native runs. */
#ifndef SONJECT_DEVICE_NATIVE_KERNEL_H
#define SONJECT_DEVICE_NATIVE_KERNEL_H

#include <stddef.h>

#include "device/device.h"

/* Runs work-items first...end - 1 of global[0] x global[1] x global[2]. */
typedef void native_function(const struct kernel_argument *arguments, const size_t *global,
                             size_t first, size_t end);

struct native_kernel {
    const char *name; /* NULL behind a program's last */
    native_function *run;
};

/* A program of one instruction set: its kernels. */
typedef const struct native_kernel *native_program;

#endif
