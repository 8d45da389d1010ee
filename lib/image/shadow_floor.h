/* The darkness of an image's shadows. */
#ifndef SONJECT_IMAGE_SHADOW_FLOOR_H
#define SONJECT_IMAGE_SHADOW_FLOOR_H

#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

struct shadow {
    double log_ratio, variance;
};

/* Shadows amid the seabed of an image, or of some parts of it. log_ratio is the logarithm of their
 * intensity over that of the seabed around them, averaged over the shadows. Its standard error
 * includes the shadows' differences. Starts as all zeros but for side. */
struct shadow_floor {
    size_t side;         /* shorter side of the whole image, pixels; 0: the given one is whole */
    struct shadow *list; /* for free(), also on failure */
    size_t listed;
    size_t shadows; /* 0: too few shadows, and the members below mean nothing */
    double log_ratio, log_error;
};

/* The mark of pixels that were used; see shadow_floor_find. */
#define SHADOW_CORE 16

/* Adds the shadows of an image, or of a part of it. A shadow is 5 dB darker than the seabed around
 * it, in means over a few rows and columns, and ends at seabed on all four sides. Dark parts that
 * reach the edge of the image or other pixels than seabed do not count. A shadow's middle third
 * along both axes tells its darkness, chosen by its place and not by its own level. intensity: rows
 * x columns. states: as many; 1 where there is no seabed, such as water, else 0. SHADOW_CORE is
 * added to the pixels that were used. Errors: MEMORY. */
sonject_status shadow_floor_find(struct report *report, const float *intensity, uint8_t *states,
                                 size_t rows, size_t columns, struct shadow_floor *found);

#endif
