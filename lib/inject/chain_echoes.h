/* What paths of several interactions add to the patch. */
#ifndef SONJECT_INJECT_CHAIN_ECHOES_H
#define SONJECT_INJECT_CHAIN_ECHOES_H

#include "inject/echoes.h"

/* Traces and forms the chains. To be called when all echoes of one interaction are in `echoes`:
 * adds to target_energy and to one realisation (the target's; by brute force, which counts
 * everything that is rough, it becomes the seabed's), fills `energy` and, where asked for,
 * order_energy. Errors: INPUT, DEVICE, MEMORY, CANCELLED. */
sonject_status chain_echoes_compute(struct echoes *echoes, struct tracer *tracer,
                                    const struct echo_request *request);

#endif
