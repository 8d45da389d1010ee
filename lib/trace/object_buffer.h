/* The buffer that kernels find objects in: a record of each part, behind them the seabed's relief
 * and the meshes. */
#ifndef SONJECT_TRACE_OBJECT_BUFFER_H
#define SONJECT_TRACE_OBJECT_BUFFER_H

#include "trace/tracer.h"

/* Where the relief is, in words from the first record; 0 where there is none. */
uint32_t object_buffer_relief_words(const struct tracer *tracer);

/* records: part_count of object_records_init; where their meshes lie is filled in. Errors: DEVICE,
 * MEMORY. */
sonject_status object_buffer_create(struct tracer *tracer, struct object_record *records,
                                    cl_mem *buffer);

#endif
