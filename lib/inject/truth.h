/* Masks, boxes and levels of every object. */
#ifndef SONJECT_INJECT_TRUTH_H
#define SONJECT_INJECT_TRUTH_H

#include "inject/echoes.h"
#include "inject/injection.h"
#include "inject/patch_level.h"

/* Fills result's masks and objects (allocated), in the view's row order. */
void find_truth(const struct tracer *tracer, const struct patch_level *level,
                const struct echoes *echoes, struct injection_result *result);

#endif
