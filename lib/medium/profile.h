/* Layers of water and sound-speed profiles as callers give them. */
#ifndef SONJECT_MEDIUM_PROFILE_H
#define SONJECT_MEDIUM_PROFILE_H

#include <stddef.h>

#include "base/report.h"
#include "medium/water_layer.h"

/* Heights closer than this are taken as the same. */
#define WATER_HEIGHT_STEP_MIN_M 1e-6
#define WATER_SPEED_MIN_MPS     100.0
#define WATER_SPEED_MAX_MPS     10000.0

/* Where a check failed. */
struct profile_place {
    size_t index;    /* of the layer or sample */
    const char *key; /* of its value, static: "bottom", "sound_speed", "density"; "heights",
                        "sound_speeds" */
};

/* Layers as sonject_scene_set_water_layers wants them, at least one. The message starts with the
 * value's name and a blank ("layers[2].bottom must be ..."); place may be NULL. Errors: INPUT. */
sonject_status check_water_layers(const struct water_layer *layers, size_t count,
                                  struct report *report, struct profile_place *place);

/* A profile as sonject_scene_set_sound_speed_profile wants it; the message starts with "heights[3]
 * ..." or "sound_speeds[3] ...". Errors: INPUT. */
sonject_status check_sound_speed_profile(const double *heights_m, const double *speeds_mps,
                                         size_t count, struct report *report,
                                         struct profile_place *place);

/* Layers of a profile that the check has let pass. Each linear piece above the seabed gives equally
 * high layers with the piece's sound speed at their middle, as many as keep the steps from one to
 * the next below 1/20000 of the speed; below the first sample and above the last one the speed is
 * theirs. Equal neighbours are one layer. On success *layers is the caller's for free(). Errors:
 * INPUT (more than WATER_LAYERS_MAX), MEMORY. */
sonject_status layers_of_profile(const double *heights_m, const double *speeds_mps, size_t count,
                                 struct report *report, struct water_layer **layers,
                                 size_t *layer_count);

#endif
