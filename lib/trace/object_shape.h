/* An object's shape as the kernels know it. */
#ifndef SONJECT_TRACE_OBJECT_SHAPE_H
#define SONJECT_TRACE_OBJECT_SHAPE_H

#include "kernels/layout.h"
#include "scene/shape_size.h"

/* Fills in the record's shape, sizes, ends and cuts. shape: sonject_shape. */
void object_shape_init(struct object_record *record, const struct shape_size *size, uint32_t shape);

#endif
