/* The fans that chains of several interactions begin with: one over the seabed around the objects,
 * one over each object. They tell how far from a part of a target chains begin on the seabed, and
 * whether chains meet the sea surface. */
#ifndef SONJECT_TRACE_CHAIN_FANS_H
#define SONJECT_TRACE_CHAIN_FANS_H

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

/* 1 + number of objects; 1 by brute force, whose fan is the patch's. */
uint32_t chain_fan_count(const struct tracer *tracer);

/* Fan number i: 0 the seabed's, then the objects'. grid: that echoes are tallied on. Errors: INPUT
 * (too many rays). */
sonject_status chain_fan_init(struct chain_fan *fan, struct tracer *tracer,
                              const struct line_grid *grid, bool has_map, uint32_t i);

#endif
