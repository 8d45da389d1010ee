/* The buffer that kernels find objects in: a record of each part, behind them the meshes, and
 * behind these what users' shapes are told. */
#ifndef SONJECT_TRACE_OBJECT_BUFFER_H
#define SONJECT_TRACE_OBJECT_BUFFER_H

#include "trace/tracer.h"

/* records: part_count of object_records_init; where their meshes lie is filled in. Errors: DEVICE,
 * MEMORY. */
sonject_status object_buffer_create(struct tracer *tracer, struct object_record *records,
                                    cl_mem *buffer);

#endif
