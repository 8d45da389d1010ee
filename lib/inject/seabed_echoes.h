/* What the seabed returns by one interaction, formed. */
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
sonject_status seabed_echoes_take(struct seabed_former *former, struct echoes *echoes,
                                  struct tracer *tracer, const struct echo_request *request,
                                  const struct impulse_lines *lines);

/* Forms lines of energies, one plane, by a response, as they come; with the last ones `formed`
 * (rows x columns of the view) is whole. Errors: DEVICE, MEMORY. */
sonject_status form_energies_as_they_come(struct form_lines *energies, struct tracer *tracer,
                                          const struct point_response *response,
                                          const struct impulse_lines *lines, float *formed);
void seabed_former_clear(struct seabed_former *former);

#endif
