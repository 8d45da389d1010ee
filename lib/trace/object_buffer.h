/* The buffer that kernels find objects in: a record of each part, behind them the seabed's relief,
 * the meshes, what users' shapes are told and, where there are many, the hierarchy over all. */
#ifndef SONJECT_TRACE_OBJECT_BUFFER_H
#define SONJECT_TRACE_OBJECT_BUFFER_H

#include "trace/tracer.h"

/* Where the relief is, in words from the first record of a launch that knows so many parts; 0 where
 * there is none. */
uint32_t object_buffer_relief_words(const struct tracer *tracer, uint32_t part_count);

/* records: those of the parts listed; where their meshes and the hierarchy lie is filled in.
 * Errors: INPUT (too large for the device), DEVICE, MEMORY. */
sonject_status object_buffer_create(struct tracer *tracer, struct object_record *records,
                                    struct part_list parts, cl_mem *buffer);

#endif
