/* What objects return by one interaction, formed: their rough surfaces and their glints. */
#ifndef SONJECT_INJECT_OBJECT_ECHOES_H
#define SONJECT_INJECT_OBJECT_ECHOES_H

#include <stdbool.h>

#include "form/form.h"
#include "inject/echo_peak.h"
#include "inject/echoes.h"
#include "inject/impulses.h"

/* The object whose sets come in. */
struct object_former {
    bool is_open;
    uint32_t number;
    struct line_grid grid; /* of its tile */
    float *rough_energy;   /* of the tile; NULL: no realisation of it is drawn */
    /* The glints of its parts, which interfere, over the columns of its echo. */
    float *glint_real, *glint_imaginary;
    struct form_lines lines; /* of the part whose glints come in */
    struct peak_lattice glint_peak, rough_peak;
};

/* Takes lines of OBJECT and GLINT. The next OBJECT finishes the one before; object_echoes_finish
 * the last. Errors: DEVICE, MEMORY. */
sonject_status object_echoes_add(struct object_former *former, struct echoes *echoes,
                                 struct tracer *tracer, const struct impulse_lines *lines);
sonject_status object_echoes_finish(struct object_former *former, struct echoes *echoes,
                                    struct tracer *tracer);
void object_former_clear(struct object_former *former);

#endif
