/* Measured and traced sound in one picture. */
#ifndef SONJECT_INJECT_COMPOSE_H
#define SONJECT_INJECT_COMPOSE_H

#include "inject/echoes.h"
#include "inject/injection.h"
#include "inject/match.h"
#include "inject/patch_level.h"

/* match: what the image around the objects tells. Fills result's image, field, energy, visibility
 * and influence (allocated, in the view's row order) from the input's pixels (same order). Errors:
 * DEVICE, MEMORY. */
sonject_status compose(struct tracer *tracer, const struct image_match *match,
                       const struct patch_level *level, const struct echoes *echoes,
                       const float *pixels, bool is_complex, struct injection_result *result);

#endif
