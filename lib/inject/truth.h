/* Masks, boxes and levels of every object. */
#ifndef SONJECT_INJECT_TRUTH_H
#define SONJECT_INJECT_TRUTH_H

#include "image/statistics.h"
#include "inject/echoes.h"
#include "inject/injection.h"
#include "inject/patch_level.h"

/* Fills result's masks and objects (allocated), in the view's row order. speckle: the
 * measured patch's. Errors: MEMORY. */
sonject_status find_truth(const struct tracer *tracer, const struct patch_level *level,
                          const struct speckle_statistics *speckle, const struct echoes *echoes,
                          struct injection_result *result);

#endif
