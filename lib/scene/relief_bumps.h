/* Mounds, pits and scour as heights. */
#ifndef SONJECT_SCENE_RELIEF_BUMPS_H
#define SONJECT_SCENE_RELIEF_BUMPS_H

#include "scene/relief.h"

/* 1 at 0, falling to 0 at 1 and staying there. share: >= 0. */
double relief_raised_cosine(double share);

/* Adds a round bump of a height (of any sign) at its middle to heights, rows x columns of the
 * relief. */
void relief_add_bump(const struct relief *relief, double *heights, double x, double y,
                     double radius, double height);

/* Takes a depth off under what an object covers, falling to 0 at a width from its outline. */
void relief_add_scour(const struct relief *relief, double *heights,
                      const struct footprint *footprint, double width, double depth);

#endif
