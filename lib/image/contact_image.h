/* An image of intensities in which contacts are measured one after the other. */
#ifndef SONJECT_IMAGE_CONTACT_IMAGE_H
#define SONJECT_IMAGE_CONTACT_IMAGE_H

#include "image/contact_mask.h"
#include "image/speckle_statistics.h"

#define SEABED_MARGIN 24 /* pixels around a box that are taken for seabed */

struct contact_image {
    const float *intensity; /* rows x columns, borrowed */
    size_t rows, columns;
    size_t *seabed_columns;   /* the first one of each row, as of find_first_return; owned */
    float *means;             /* over 3 x 3 pixels; owned */
    uint8_t *marks;           /* enum contact_part, of the contact measured last; owned */
    struct window_box marked; /* beyond which marks are 0 */
    uint8_t *taken;           /* not 0: of any contact measured so far; owned */
    struct speckle_statistics speckle; /* of all pixels */
};

/* The intensities must outlive it. Errors: MEMORY. To be given to contact_image_clear, after
 * failure as well. */
sonject_status contact_image_create(struct contact_image *image, struct report *report,
                                    const float *intensity, size_t rows, size_t columns);
void contact_image_clear(struct contact_image *image);

/* The mean intensity of what is around a box, or within it too where nothing is: the median of
 * blocks, so that stones and shadows there do not count. Errors: MEMORY. */
sonject_status find_seabed_level(const struct contact_image *image, struct report *report,
                                 const struct window_box *box, double *level);

/* Likewise of all that is in a box; blocks: seabed_blocks(box) places. */
double level_within(const struct contact_image *image, const struct window_box *box, float *blocks);
size_t seabed_blocks(const struct window_box *box);

#endif
