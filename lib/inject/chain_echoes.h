/* What paths of several interactions add to the patch. */
#ifndef SONJECT_INJECT_CHAIN_ECHOES_H
#define SONJECT_INJECT_CHAIN_ECHOES_H

#include "inject/echoes.h"
#include "inject/impulses.h"

struct chain_former {
    struct line_grid grid;
    float *sum; /* of all orders on the grid; NULL: none came in */
};

/* Takes lines of CHAINS; forms order_energy where that is wanted. Errors: DEVICE, MEMORY. */
sonject_status chain_echoes_add(struct chain_former *former, struct echoes *echoes,
                                struct tracer *tracer, const struct impulse_lines *lines);

/* To be called when all else is in `echoes`, also where no chains came in: adds them to
 * target_energy and to one realisation (the target's; by brute force, which counts everything that
 * is rough, it becomes the seabed's), and fills `energy` and the first order's. Errors: DEVICE,
 * MEMORY. */
sonject_status chain_echoes_finish(struct chain_former *former, struct echoes *echoes,
                                   struct tracer *tracer);
void chain_former_clear(struct chain_former *former);

#endif
