/* A level layer of water of one sound speed. */
#ifndef SONJECT_MEDIUM_WATER_LAYER_H
#define SONJECT_MEDIUM_WATER_LAYER_H

#include <stddef.h>

#include "base/report.h"

#define WATER_LAYERS_MAX 4096

/* Layers are listed from the seabed upwards, the first at 0; each ends where the next begins, the
 * last has no upper edge. */
struct water_layer {
    double bottom_m; /* height of its lower edge over the mean seabed */
    double speed_mps;
    double density; /* in the unit of all the others */
};

#endif
