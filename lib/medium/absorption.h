/* What sea water absorbs. */
#ifndef SONJECT_MEDIUM_ABSORPTION_H
#define SONJECT_MEDIUM_ABSORPTION_H

#include <sonject/medium.h>

#include "base/ranges.h"

#define ABSORPTION_FREQUENCY_MIN_HZ 200.0
#define ABSORPTION_FREQUENCY_MAX_HZ 1e6

struct sea_water {
    double temperature_celsius; /* -2...30 */
    double salinity_permille;   /* 0...40 */
    double depth_m;             /* below the sea surface, 0...5000 */
    double ph;                  /* 7...9 */
};

/* Ranges in which the formula of sonject_absorption holds, in the manner of the checks in
 * scene/scene.h: keys are "temperature", "salinity", "depth" and "ph". Errors: INPUT. */
sonject_status check_sea_water(const struct sea_water *water, struct report *report,
                               struct check_listener *listener);

#endif
