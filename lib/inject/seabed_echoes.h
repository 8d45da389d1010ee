/* What the seabed returns by one interaction, formed: as it is; as it would be if it were level,
 * for a composite changes the measured pixels by the ratio of what relief and objects leave to
 * that; and what targets hide of it in a real aperture's images, as each ping's beam sees them. */
#ifndef SONJECT_INJECT_SEABED_ECHOES_H
#define SONJECT_INJECT_SEABED_ECHOES_H

#include "form/form.h"
#include "inject/echoes.h"
#include "inject/impulses.h"

/* The seabed's lines, or the level seabed's after them. */
struct seabed_former {
    struct form_lines energies, field;
    float *in_view, *imaginary; /* of a chunk: the coherent field */
};

/* Takes lines of SEABED. With the last ones seabed_energy and, where it is wanted, the realisation
 * are whole. Errors: DEVICE, MEMORY. */
sonject_status seabed_echoes_add(struct seabed_former *former, struct echoes *echoes,
                                 struct tracer *tracer, const struct echo_request *request,
                                 const struct impulse_lines *lines);

/* Forms lines of energies, one plane, by a response, as they come; with the last ones `formed`
 * (rows x columns of the view) is whole. Errors: DEVICE, MEMORY. */
sonject_status form_energies_as_they_come(struct form_lines *energies, struct tracer *tracer,
                                          const struct point_response *response,
                                          const struct impulse_lines *lines, float *formed);
void seabed_former_clear(struct seabed_former *former);

/* The reflectivity that the seabed's energies are traced with. With relief a composite takes an
 * even one: the ratio of two energies is then that of geometry, not of the speckle of two places;
 * level_seabed_add gives the energies the map's pattern. */
const float *seabed_map(const struct tracer *tracer, const struct echo_request *request);

/* Takes lines of LEVEL, after those of seabed and objects. With the last ones level_energy is
 * whole. Errors: DEVICE, MEMORY. */
sonject_status level_seabed_add(struct seabed_former *former, struct echoes *echoes,
                                struct tracer *tracer, const struct echo_request *request,
                                const struct impulse_lines *lines);

/* Whether the scene's shadows are found within the beam: its sonar has a real aperture, over a
 * level seabed. Shadows over relief keep to lines from broadside. */
bool has_beam_shadows(const struct tracer *tracer);

/* A response that keeps rows apart: a ping's energies are its row's as they are. */
void response_of_pings(struct point_response *response, const struct tracer *tracer);

/* In the making. Zeroed at first; to be given to beam_former_clear at last. */
struct beam_former {
    struct form_lines lines;
    float *seabed; /* of an even seabed, the patch's size */
};

/* Takes lines of BEAM, all of them before those of HIDDEN, and both after those of objects.
 * lost_energy and the objects' lost, which came from broadside, become the shares of seabed_energy
 * that rays within the beam find hidden of an even seabed. Errors: DEVICE, MEMORY. */
sonject_status beam_shadows_add(struct beam_former *former, struct echoes *echoes,
                                struct tracer *tracer, const struct impulse_lines *lines);
void beam_former_clear(struct beam_former *former);

#endif
