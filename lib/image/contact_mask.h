/* Which pixels of an image are a contact's highlight and shadow. */
#ifndef SONJECT_IMAGE_CONTACT_MASK_H
#define SONJECT_IMAGE_CONTACT_MASK_H

#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

#define HIGHLIGHT_OVER_SEABED 4.0  /* mean of 3 x 3 pixels: 6 dB over the seabed */
#define HIGHLIGHT_UNDER_PEAK  0.01 /* side lobes of bright echoes are not the contact */
#define SHADOW_UNDER_SEABED   0.25

enum contact_part {
    PART_NONE,
    PART_HIGHLIGHT,
    PART_SHADOW
};

/* A rectangle of an image of intensities. */
struct window_box {
    size_t first_row, first_column, rows, columns;
};

/* A connected set of pixels (by sides). */
struct contact_area {
    struct window_box box; /* around it; rows 0: there is none */
    size_t pixels;
    double energy; /* sum of intensities */
};

/* Mean over 3 x 3 pixels, fewer at the image's edges. */
void mean_of_neighbours(const float *intensity, size_t rows, size_t columns, float *mean);

/* Marks with `part` the area of pixels of `box` for which means lie beyond the threshold (above it
 * for a highlight, below it for a shadow), marks[] still 0: of all such areas the one of most
 * energy, or for a shadow of most pixels. stack: box->rows * box->columns places. */
struct contact_area mark_largest_area(const float *means, const float *intensity, size_t columns,
                                      const struct window_box *box, enum contact_part part,
                                      double threshold, uint8_t *marks, size_t *stack);

#endif
