/* The seabed of a real aperture's images, and what targets hide of it, as each ping's beam sees
 * them. */
#ifndef SONJECT_INJECT_BEAM_SHADOWS_H
#define SONJECT_INJECT_BEAM_SHADOWS_H

#include "inject/echoes.h"

/* Where the scene's sonar has a real aperture, over a level seabed: puts the energies that rays
 * within the beam find in the place of seabed_energy, lost_energy and the objects' lost, which came
 * from abreast. map: as the seabed was traced with. Else does nothing: shadows over relief keep to
 * lines from abreast. Errors: as rough_trace_begin, CANCELLED. */
sonject_status beam_shadows_compute(struct echoes *echoes, struct tracer *tracer,
                                    const struct echo_request *request, const float *map);

#endif
