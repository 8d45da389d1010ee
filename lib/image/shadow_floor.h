/* How dark an image's shadows are. */
#ifndef SONJECT_IMAGE_SHADOW_FLOOR_H
#define SONJECT_IMAGE_SHADOW_FLOOR_H

#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

struct shadow {
    double log_ratio, variance;
};

/* Shadows that lie amid the seabed of an image, or of some parts of it. log_ratio is the logarithm
 * of their intensity over the seabed's about them, the mean over the shadows; its standard error
 * has in it how much shadows differ. Starts as all zeros but for side. */
struct shadow_floor {
    size_t side;         /* pixels, the shorter one of the whole image; 0: what is given is whole */
    struct shadow *list; /* for free(), also on failure */
    size_t listed;
    size_t shadows; /* 0: too few are seen, and the others mean nothing */
    double log_ratio, log_error;
};

/* Where the pixels are that tell it; see shadow_floor_find. */
#define SHADOW_CORE 16

/* Adds the shadows of an image, or of a part of it. A shadow is 5 dB darker than the seabed about
 * it in means over a few rows and columns, and ends at seabed before and behind it and on either
 * side: what reaches the edge of the image or of what is no seabed is none. Its middle third along
 * both axes tells its darkness, chosen by its place and not by its own level. intensity: rows x
 * columns. states: room for as many; holds 1 where there is no seabed, such as water, else 0;
 * SHADOW_CORE is added to the pixels that were used. Errors: MEMORY. */
sonject_status shadow_floor_find(struct report *report, const float *intensity, uint8_t *states,
                                 size_t rows, size_t columns, struct shadow_floor *found);

#endif
