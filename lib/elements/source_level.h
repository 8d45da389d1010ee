/* From ratios of pressures to pressures: a source level, and what the water absorbs. */
#ifndef SONJECT_ELEMENTS_SOURCE_LEVEL_H
#define SONJECT_ELEMENTS_SOURCE_LEVEL_H

#include "elements/impulse_list.h"
#include "scene/patch_view.h"

/* Scales impulses to the pressure, in Pa m, that a source of this level makes of them: sqrt(2)
 * times its rms pressure at 1 m, 10^(level / 20) uPa, less absorption on the way there and back at
 * the impulse's own range. */
void impulse_list_set_source_level(struct impulse_list *list, const struct patch_view *view,
                                   double source_level_db, double absorption_db_per_m);

#endif
