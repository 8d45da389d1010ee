/* The sea surface within chains of several interactions. */
#ifndef SONJECT_TRACE_SEA_SURFACE_H
#define SONJECT_TRACE_SEA_SURFACE_H

#include "trace/tracer.h"

/* Whether chains meet the sea surface: there is one, it returns sound in a way that chains count,
 * no layer bends the sound below it, and the patch holds some of its echoes. The earliest of these
 * has half a path of (|OC| + |O'C|)/2 less the radius around a target's centre C, O' the sonar's
 * image in the surface: no path by way of target and surface is shorter. grid: that echoes are
 * tallied on. */
bool sea_surface_is_in_chains(const struct tracer *tracer, const struct line_grid *grid);

#endif
