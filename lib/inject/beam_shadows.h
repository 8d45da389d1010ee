/* What targets hide of the seabed in a real aperture's images, as each ping's beam sees them. */
#ifndef SONJECT_INJECT_BEAM_SHADOWS_H
#define SONJECT_INJECT_BEAM_SHADOWS_H

#include "inject/echoes.h"

/* Where the scene's sonar has a real aperture, over a level seabed: lost_energy and the objects'
 * lost, which came from abreast, become the shares of seabed_energy that rays within the beam find
 * hidden of an even seabed. Else does nothing: shadows over relief keep to lines from abreast.
 * Errors: as rough_trace_begin, CANCELLED. */
sonject_status beam_shadows_compute(struct echoes *echoes, struct tracer *tracer,
                                    const struct echo_request *request);

#endif
