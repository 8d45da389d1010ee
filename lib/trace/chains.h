/* The incoherent part beyond the first interaction: energies of chains between seabed, objects and
 * sea surface. Chains begin with fans of rays: one over the seabed around the objects, one over
 * each object. */
#ifndef SONJECT_TRACE_CHAINS_H
#define SONJECT_TRACE_CHAINS_H

#include "trace/object_buffer.h"
#include "trace/tracer.h"

/* Whether chains meet the sea surface: there is one, it returns sound in a way that chains count,
 * no layer bends the sound below it, and the patch holds some of its echoes. The earliest of these
 * has half a path of (|OC| + |O'C|)/2 less the radius around a target's centre C, O' the sonar's
 * image in the surface: no path by way of target and surface is shorter. grid: that echoes are
 * tallied on. */
bool sea_surface_is_in_chains(const struct tracer *tracer, const struct line_grid *grid);

/* From the part's centre, m: along-track and away from the sonar, and towards the sonar. */
struct chain_reach {
    double around_m, towards_sonar_m;
};

/* Seabed outside the rectangle of these exchanges less than 1 % of the sound that comes with at
 * most the part's mean height of detour (kernels/MATH.md, "Chains"). */
struct chain_reach chain_reach_of(const struct tracer *tracer, const struct placement *placement);

/* A fan and the strips that it is to be traced on, which may lie beyond the patch: sound goes aside
 * between seabed and object. */
struct chain_fan {
    struct fan_record record;
    struct span strips;
};

/* 1 by brute force, whose fan is the patch's; else 1 + number of parts (an object without parts is
 * one) + number of objects. */
uint32_t chain_fan_count(const struct tracer *tracer);

/* Fan number i: 0 the seabed's, then the parts', then the samples of second order of each object.
 * It has no strips where there is nothing to trace, or the tracer does not follow the object. grid:
 * that echoes are tallied on. Errors: INPUT (too many rays). */
sonject_status chain_fan_init(struct chain_fan *fan, struct tracer *tracer,
                              const struct line_grid *grid, bool has_map, uint32_t i);

/* Whether paths between seabed and a target, of two interactions, are sampled by the cells that
 * their echoes end in, not followed from the seabed: one path stands for its reverse, and the sea
 * surface has no part in them. */
bool second_order_is_sampled(const struct tracer *tracer, const struct line_grid *grid);

/* Adds the targets' records behind spheres, and what samples need to the chains' record. */
void second_order_init(struct chain_record *record, struct target_spheres *spheres,
                       const struct tracer *tracer, const struct line_grid *grid,
                       const double origin[3]);

/* Lays the samples of an object into a fan that is aimed at the patch. */
void second_order_fan_init(struct chain_fan *fan, const struct tracer *tracer,
                           const struct line_grid *grid, uint32_t object);

/* The number of a rough part's record: of rough parts before it. */
int32_t second_order_target(const struct tracer *tracer, uint32_t part);

/* About the most that a sample may bring, over what 1 m rad of wavefront does before it is
 * returned. */
double second_order_most(const struct tracer *tracer, const struct line_grid *grid);

/* Rays of a part's fan in a bin. */
double chain_rays_per_bin(const struct tracer *tracer, const struct line_grid *grid, uint32_t part);

/* The launch's buffers. */
enum chain_buffer {
    CHAIN_RECORD,
    CHAIN_OBJECTS,
    CHAIN_SPHERES,
    CHAIN_MAP,
    CHAIN_TALLIES
};

struct chain_trace {
    struct line_grid grid; /* of the patch with its margins */
    uint32_t first_order;  /* interactions of the shortest path that is counted: 2, or 1 by brute
                              force, which counts everything */
    uint32_t orders;       /* from first_order on; each has a plane of the tally */
    int exponents[CHAIN_ORDERS_MAX]; /* of two: quanta per m^2 of the device's, by order */
    bool has_map, has_sea_surface;
    struct ray_table_record table; /* of the rays of all fans */
    struct launch launch;
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
                                  const struct chain_fan *fan, struct span strips);

/* Reads a plane, 0 for first_order: energies in m^2, line_grid_cells(&trace->grid) of them. */
sonject_status chain_trace_read(struct chain_trace *trace, struct tracer *tracer, uint32_t plane,
                                float *energy);

#endif
