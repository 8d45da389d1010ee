/* What the seabed would return if it were level: a composite changes the measured pixels by the
 * ratio of what relief and objects leave to that. */
#ifndef SONJECT_INJECT_LEVEL_SEABED_H
#define SONJECT_INJECT_LEVEL_SEABED_H

#include "inject/seabed_echoes.h"

/* The reflectivity that the seabed's energies are traced with. With relief a composite takes an
 * even one: the ratio of two energies is then that of geometry, not of the speckle of two places;
 * level_seabed_take gives the energies the map's pattern. */
const float *seabed_map(const struct tracer *tracer, const struct echo_request *request);

/* Takes lines of LEVEL, after those of seabed and objects. With the last ones level_energy is
 * whole. Errors: DEVICE, MEMORY. */
sonject_status level_seabed_take(struct seabed_former *former, struct echoes *echoes,
                                 struct tracer *tracer, const struct echo_request *request,
                                 const struct impulse_lines *lines);

#endif
