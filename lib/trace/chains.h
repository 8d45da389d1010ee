/* The incoherent part beyond the first interaction: energies of chains between seabed, objects and
 * sea surface. */
#ifndef SONJECT_TRACE_CHAINS_H
#define SONJECT_TRACE_CHAINS_H

#include "trace/chain_fans.h"

struct chain_trace {
    struct line_grid grid; /* of the patch with its margins */
    uint32_t first_order;  /* interactions of the shortest path that is counted: 2, or 1 by brute
                              force, which counts everything */
    uint32_t orders;       /* from first_order on */
    uint32_t planes;       /* orders if they are kept apart, else 1 */
    int exponents[CHAIN_ORDERS_MAX]; /* of two: quanta per m^2 of the device's, by order */
    bool has_map, has_sea_surface;
    struct ray_table rays; /* of all fans */
    struct ray_table_record table;
    device_kernel kernel;
    device_buffer chains, objects, spheres, map, tallies;
};

/* Prepares a trace; as rough_trace_begin. With one interaction (or no object, unless by brute
 * force) there is nothing to trace: orders is 0 and nothing is held. Errors: INPUT (too many rays,
 * patch too large), DEVICE, MEMORY. */
sonject_status chain_trace_begin(struct chain_trace *trace, struct tracer *tracer,
                                 const float *map);
void chain_trace_end(struct chain_trace *trace);

/* Follows the rays of a fan (chain_fan_init) that start at some of its strips. Echoes add up on the
 * device. */
sonject_status chain_trace_strips(struct chain_trace *trace, struct tracer *tracer,
                                  struct chain_fan *fan, struct span strips);

/* Reads a plane: energies in m^2, line_grid_cells(&trace->grid) of them. */
sonject_status chain_trace_read(struct chain_trace *trace, struct tracer *tracer, uint32_t plane,
                                float *energy);

#endif
