/* The deviates that image formation draws, as numbers. */
#ifndef SONJECT_ELEMENTS_SPECKLE_H
#define SONJECT_ELEMENTS_SPECKLE_H

#include "base/report.h"
#include "cl/device.h"
#include "scene/line_grid.h"

/* sqrt(energy) times complex normal deviates that depend on seed, stream, strip and bin alone, for
 * strips.count x bins.count cells of one grid, in two planes. Errors: DEVICE, MEMORY. */
sonject_status speckle_draw(struct report *report, struct device *device, struct span bins,
                            struct span strips, const float *energy, uint64_t seed, uint32_t stream,
                            float *real_part, float *imaginary_part);

#endif
