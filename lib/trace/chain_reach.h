/* How far from a part of a target chains of sound begin on the seabed. */
#ifndef SONJECT_TRACE_CHAIN_REACH_H
#define SONJECT_TRACE_CHAIN_REACH_H

#include "trace/tracer.h"

/* From the part's centre, m: along-track and away from the sonar, and towards the sonar. */
struct chain_reach {
    double around_m, towards_sonar_m;
};

/* Seabed outside the rectangle of these exchanges less than 1 % of the sound that comes with at
 * most the part's mean height of detour (kernels/MATH.md, "Chains"). */
struct chain_reach chain_reach_of(const struct tracer *tracer, const struct placement *placement);

#endif
