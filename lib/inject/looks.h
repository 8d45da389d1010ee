/* Pixels of several looks: images that were averaged before they were stored. */
#ifndef SONJECT_INJECT_LOOKS_H
#define SONJECT_INJECT_LOOKS_H

#include "inject/echoes.h"
#include "inject/injection.h"
#include "inject/patch_level.h"

/* Weights of the looks whose weighted mean intensity has the contrast of `looks` (1...64, a
 * fraction too) independent equal ones: all but the last are *weight, the last is *last. Returns
 * their number. */
uint32_t look_weights(double looks, double *weight, double *last);

/* Composes the touched pixels (result->influence, within the window) of a magnitude image anew as
 * the root of a mean over looks: of the measured seabed, the noise and the rough targets each look
 * has its own realisation, glints are the same in all. result->visibility is filled in already;
 * image and field are changed. Errors: DEVICE, MEMORY. */
sonject_status compose_looks(struct tracer *tracer, double looks, const struct patch_level *level,
                             const struct echoes *echoes, const float *pixels,
                             const struct window *window, struct injection_result *result);

#endif
