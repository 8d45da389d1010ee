/* The kernels' own functions compiled as native C with 16 SIMD lanes, for comparison. */
#ifndef SONJECT_TESTS_NATIVE_KERNEL_H
#define SONJECT_TESTS_NATIVE_KERNEL_H

#include "kernels/layout.h"

/* Over strips [first, last) of a launch, with its buffers in its order. Threads must not share the
 * tallies that they fill. */
typedef void native_program(const struct fan_record *fan, void *const *buffers, uint32_t first,
                            uint32_t last, struct outcome_record *outcomes);

native_program native_trace_rough, native_trace_smooth, native_trace_chains;

#endif
