/* The kernels' object_distance and object_normal at several lanes, as native C. */
#ifndef SONJECT_TESTS_LANES_H
#define SONJECT_TESTS_LANES_H

#include "layout.h"

#define LANES 8

/* rays: x, y, z of points, then of directions, LANES each; distance: LANES; normal: x, y, z, LANES
 * each. */
void lanes_hit(const struct object_record *object, float rays[6][LANES], float minimum,
               float distance[LANES], float normal[3][LANES]);

#endif
