/* What targets hide of the seabed in a real aperture's images, as each ping's beam sees them. */
#ifndef SONJECT_INJECT_BEAM_SHADOWS_H
#define SONJECT_INJECT_BEAM_SHADOWS_H

#include "form/form.h"
#include "inject/echoes.h"
#include "inject/impulses.h"

/* Whether the scene's shadows are found within the beam: its sonar has a real aperture, over a
 * level seabed. Shadows over relief keep to lines from abreast. */
bool has_beam_shadows(const struct tracer *tracer);

/* A response that keeps rows apart: a ping's energies are its row's as they are. */
void response_of_pings(struct point_response *response, const struct tracer *tracer);

/* In the making. Zeroed at first; to be given to beam_former_clear at last. */
struct beam_former {
    struct form_lines lines;
    float *seabed; /* of an even seabed, the patch's size */
};

/* Takes lines of BEAM, all of them before those of HIDDEN, and both after those of objects.
 * lost_energy and the objects' lost, which came from abreast, become the shares of seabed_energy
 * that rays within the beam find hidden of an even seabed. Errors: DEVICE, MEMORY. */
sonject_status beam_shadows_take(struct beam_former *former, struct echoes *echoes,
                                 struct tracer *tracer, const struct impulse_lines *lines);
void beam_former_clear(struct beam_former *former);

#endif
