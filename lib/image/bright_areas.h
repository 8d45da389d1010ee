/* What stands out of an image's seabed. */
#ifndef SONJECT_IMAGE_BRIGHT_AREAS_H
#define SONJECT_IMAGE_BRIGHT_AREAS_H

#include "image/contact_parts.h"

/* A connected area that is HIGHLIGHT_OVER_SEABED and more over the seabed around it. */
struct bright_area {
    struct window_box box;
    double contrast; /* of its brightest mean of 3 x 3 pixels over the seabed */
};

/* Lists them: the brightest first, then by row and column; none that begins before the first return
 * of a sidescan image or with it. *areas is for free(), after failure as
 * well. Errors: MEMORY. */
sonject_status list_bright_areas(struct report *report, const struct contact_image *image,
                                 struct bright_area **areas, size_t *count);

#endif
