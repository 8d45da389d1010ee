/* Which pixels of an image are a contact's highlight and shadow. */
#ifndef SONJECT_IMAGE_CONTACT_MASK_H
#define SONJECT_IMAGE_CONTACT_MASK_H

#include <stdbool.h>
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

/* The box with so many pixels around it, within the image. */
struct window_box box_with_margin(const struct window_box *box, size_t margin, size_t rows,
                                  size_t columns);

/* The smallest box around both, and what both have in common; they must overlap for that. */
struct window_box box_around(const struct window_box *a, const struct window_box *b);
struct window_box box_within(const struct window_box *a, const struct window_box *b);
bool boxes_overlap(const struct window_box *a, const struct window_box *b);

/* A connected set of pixels (by sides). */
struct contact_area {
    struct window_box box; /* around it; rows 0: there is none */
    size_t pixels;
    double energy; /* sum of intensities */
};

/* Mean over 3 x 3 pixels, fewer at the image's edges. */
void mean_of_neighbours(const float *intensity, size_t rows, size_t columns, float *mean);

/* Areas of pixels of `box` for which means lie beyond the threshold: above it for a highlight,
 * below it for a shadow. */
struct area_search {
    const float *means, *intensity; /* of the image */
    size_t columns;                 /* of the image */
    struct window_box box;
    size_t start_columns; /* of the box, its first ones: an area must have a pixel in them */
    enum contact_part part;
    double threshold;
    uint8_t *marks; /* of the image: where one is not 0 no area is */
    size_t *stack;  /* box.rows * box.columns places */
};

/* Marks with the part that area which has the most energy, or for a shadow the most pixels. */
struct contact_area mark_largest_area(const struct area_search *search);

#endif
