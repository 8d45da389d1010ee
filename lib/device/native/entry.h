/* OpenCL C's words for entry points, as plain C. native.py's files compile the kernels with it,
 * once for each instruction set. */
#ifndef SONJECT_DEVICE_NATIVE_ENTRY_H
#define SONJECT_DEVICE_NATIVE_ENTRY_H

#include <stddef.h>
#include <stdint.h>

#include "device/native/kernel.h"

#define __kernel static
#define __global
#define uint               uint32_t
#define get_global_id(way) native_item[way]

/* The calling thread's current work-item. */
static __thread size_t native_item[3];

/* Goes to the next work-item in the device's order: the first dimension runs fastest. */
static inline void native_item_next(const size_t *global)
{
    if (++native_item[0] < global[0])
        return;
    native_item[0] = 0;
    if (++native_item[1] < global[1])
        return;
    native_item[1] = 0;
    native_item[2]++;
}

static inline void native_item_begin(const size_t *global, size_t item)
{
    native_item[0] = item % global[0];
    native_item[1] = item / global[0] % global[1];
    native_item[2] = item / global[0] / global[1];
}

#endif
