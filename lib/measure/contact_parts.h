/* An image of intensities in which contacts are measured one after the other, and which pixels are
 * a contact's highlight and shadow. */
#ifndef SONJECT_MEASURE_CONTACT_PARTS_H
#define SONJECT_MEASURE_CONTACT_PARTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"
#include "image/statistics.h"

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

#define PIECE_GAP  6  /* pixels between pieces of one highlight, at most */
#define PIECES_MAX 32 /* beside the first */

/* Where a contact is looked for. */
struct contact_place {
    struct window_box box;    /* that holds all of it */
    struct window_box bright; /* within the box: holds the highlight */
    bool is_near; /* the shadow begins behind the highlight: dark areas further off are others' */
};

/* Marks in the image the area of most energy with what lies near it, and the largest dark area that
 * reaches beyond its near edge, in its rows; no other contact's marks are left. Either area may be
 * empty. Errors: MEMORY. */
sonject_status find_contact_parts(struct contact_image *image, struct report *report,
                                  const struct contact_place *place, double seabed,
                                  struct contact_area *highlight, struct contact_area *shadow);

#endif
