/* Ripples of sand as heights. */
#ifndef SONJECT_SCENE_RELIEF_RIPPLES_H
#define SONJECT_SCENE_RELIEF_RIPPLES_H

#include "scene/relief.h"

/* Adds ripples to heights, rows x columns of the relief. Errors: MEMORY. */
sonject_status relief_add_ripples(const struct relief *relief, struct report *report,
                                  const struct relief_feature *feature, bool is_mirrored,
                                  double *heights);

#endif
