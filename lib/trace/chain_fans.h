/* The fans that chains of several interactions begin with: one over the seabed around the objects,
 * one over each object. */
#ifndef SONJECT_TRACE_CHAIN_FANS_H
#define SONJECT_TRACE_CHAIN_FANS_H

#include "trace/tracer.h"

/* A fan and the strips that it is to be traced on, which may lie beyond the patch: sound goes aside
 * between seabed and object. */
struct chain_fan {
    struct fan_record record;
    struct span strips;
};

/* 1 + number of objects; 1 by brute force, whose fan is the patch's. */
uint32_t chain_fan_count(const struct tracer *tracer);

/* Fan number i: 0 the seabed's, then the objects'. grid: that echoes are tallied on. Errors: INPUT
 * (too many rays). */
sonject_status chain_fan_init(struct chain_fan *fan, struct tracer *tracer,
                              const struct line_grid *grid, bool has_map, uint32_t i);

#endif
