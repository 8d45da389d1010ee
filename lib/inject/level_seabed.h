/* What the seabed would return if it were level: a composite changes the measured pixels by the
 * ratio of what relief and objects leave to that. */
#ifndef SONJECT_INJECT_LEVEL_SEABED_H
#define SONJECT_INJECT_LEVEL_SEABED_H

#include "inject/echoes.h"

/* The reflectivity that the seabed's energies are traced with. With relief a composite takes an
 * even one: the ratio of two energies is then that of geometry, not of the speckle of two places;
 * level_seabed_compute gives the energies the map's pattern. */
const float *seabed_map(const struct tracer *tracer, const struct echo_request *request);

/* Traces the level seabed by the same rays and forms it into echoes->level_energy. The trace is
 * level from then on. Errors: DEVICE, MEMORY, CANCELLED. */
sonject_status level_seabed_compute(struct echoes *echoes, struct tracer *tracer,
                                    const struct echo_request *request, struct rough_trace *trace);

#endif
