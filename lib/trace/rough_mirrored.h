/* The incoherent part by way of mirrors: out or home, or both, by an image of the sonar. */
#ifndef SONJECT_TRACE_ROUGH_MIRRORED_H
#define SONJECT_TRACE_ROUGH_MIRRORED_H

#include "trace/rough.h"

/* Adds to the objects' tiles (TILE_ENERGY) what mirrors carry to and from their rough surfaces.
 * Errors: DEVICE, MEMORY. */
sonject_status rough_trace_mirrored(struct rough_trace *trace, struct tracer *tracer);

#endif
