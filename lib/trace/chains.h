/* The incoherent part beyond the first interaction: energies of chains. A chain is a path that
 * meets seabed, objects and sea surface two times or more. Chains begin with fans of rays: one over
 * the seabed around the objects, and one over each part of an object. */
#ifndef SONJECT_TRACE_CHAINS_H
#define SONJECT_TRACE_CHAINS_H

#include "trace/object_buffer.h"
#include "trace/tracer.h"

/* Returns whether chains meet the sea surface. The surface must be rough, or smooth with three
 * interactions or more. No layer may bend sound below it, and the patch must hold some echoes. The
 * earliest echo has half a path of (|OC| + |O'C|)/2 less the radius around a target's centre C. O'
 * is the sonar's image in the surface. No path by way of target and surface is shorter. grid: the
 * grid on which echoes are tallied. */
bool sea_surface_is_in_chains(const struct tracer *tracer, const struct line_grid *grid);

/* The reach of chains on the seabed, from a part's centre, m: along-track and away from the sonar,
 * and towards the sonar. */
struct chain_reach {
    double around_m, towards_sonar_m;
};

/* Returns the rectangle of seabed that exchanges sound with a part. Less than 1 % of the sound
 * whose detour is at most the part's mean height comes from outside (kernels/MATH.md, "Chains"). */
struct chain_reach chain_reach_of(const struct tracer *tracer, const struct placement *placement);

/* A fan and its strips. Sound goes aside on the way, so the strips may leave the patch. */
struct chain_fan {
    struct fan_record record;
    struct span strips;
};

/* Returns the number of fans: 1 by brute force, whose fan is the patch's, else 1 + number of parts
 * + number of objects. An object without parts counts as one part. */
uint32_t chain_fan_count(const struct tracer *tracer);

/* Fills in fan number i: 0 is the seabed's, then come the parts', then the samples of second order
 * of each object. The fan has no strips where nothing is to be traced, or the tracer does not
 * follow the object. grid: the grid on which echoes are tallied. Errors: INPUT (too many rays). */
sonject_status chain_fan_init(struct chain_fan *fan, struct tracer *tracer,
                              const struct line_grid *grid, bool has_map, uint32_t i);

/* Returns whether paths of two interactions between seabed and a target are sampled by the cells
 * where their echoes end. Otherwise rays from the seabed find them. Sampling needs paths that stand
 * for their reverse, and chains without the sea surface. */
bool second_order_is_sampled(const struct tracer *tracer, const struct line_grid *grid);

/* Adds the targets' records behind the spheres, and completes the chains' record for samples. */
void second_order_init(struct chain_record *record, struct target_spheres *spheres,
                       const struct tracer *tracer, const struct line_grid *grid,
                       const double origin[3]);

/* Turns a fan that is aimed at the patch into the samples of an object. */
void second_order_fan_init(struct chain_fan *fan, const struct tracer *tracer,
                           const struct line_grid *grid, uint32_t object);

/* Returns the number of a rough part's record, which is the number of rough parts before it. */
int32_t second_order_target(const struct tracer *tracer, uint32_t part);

/* Returns about the most that a sample may bring before its sound is returned: its share of a
 * part's wavefront, m rad, times the most that the part scatters. */
double second_order_most(const struct tracer *tracer, const struct line_grid *grid);

/* Returns the number of rays that a part's fan has in a bin. */
double chain_rays_per_bin(const struct tracer *tracer, const struct line_grid *grid, uint32_t part);

struct chain_trace {
    struct line_grid grid; /* the patch's, with its margins */
    uint32_t
        first_order; /* interactions of the shortest path that is counted: 2, or 1 by brute force */
    uint32_t orders; /* number of orders from first_order on; each has a plane of the tally */
    int exponents[CHAIN_ORDERS_MAX]; /* log2 of quanta per m^2 on the device, by order */
    bool has_map, has_sea_surface;
    struct ray_table_record table; /* describes the rays of all fans */
    struct launch launch;
};

/* Prepares a trace like rough_trace_begin. There is nothing to trace with one interaction, or
 * without objects unless by brute force. Then orders is 0 and nothing is held. Errors: INPUT (too
 * many rays, patch too large), DEVICE, MEMORY. */
sonject_status chain_trace_begin(struct chain_trace *trace, struct tracer *tracer,
                                 const float *map);
void chain_trace_end(struct chain_trace *trace);

/* Follows the rays of a fan that start at some of its strips. Echoes add up on the device. */
sonject_status chain_trace_strips(struct chain_trace *trace, struct tracer *tracer,
                                  const struct chain_fan *fan, struct span strips);

/* Reads a plane, 0 for first_order, of line_grid_cells(&trace->grid) energies in m^2. */
sonject_status chain_trace_read(struct chain_trace *trace, struct tracer *tracer, uint32_t plane,
                                float *energy);

#endif
