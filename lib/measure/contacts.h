/* Contacts in an image of intensities: their highlights and shadows, and their sizes.
 * Measured and injected contacts are treated alike. The measures' names: sonject/measure.h. */
#ifndef SONJECT_MEASURE_CONTACTS_H
#define SONJECT_MEASURE_CONTACTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <sonject/result.h>

#include "base/report.h"
#include "image/statistics.h"

#define HIGHLIGHT_OVER_SEABED 4.0  /* over the seabed, mean of 3 x 3 pixels: 6 dB */
#define HIGHLIGHT_UNDER_PEAK  0.01 /* over the peak; side lobes of bright echoes are fainter */
#define SHADOW_UNDER_SEABED   0.25
#define SEABED_MARGIN         24 /* rim around a box that counts as seabed, pixels */
#define CONTACT_MARGIN        6  /* rim around highlight and shadow in a contact's box, pixels */
#define PIECE_GAP             6  /* largest gap between pieces of one highlight, pixels */
#define PIECES_MAX            32 /* most pieces beside the first */

enum contact_part {
    PART_NONE,
    PART_HIGHLIGHT,
    PART_SHADOW
};

/* Compares floats for qsort, in ascending order. */
int compare_floats(const void *a, const void *b);

/* Returns a box widened by a margin of pixels on each side, within the image. */
sonject_box box_with_margin(const sonject_box *box, size_t margin, size_t rows, size_t columns);

/* Return the smallest box around both. Of a contact's parts, either may be empty. */
sonject_box box_around(const sonject_box *a, const sonject_box *b);
sonject_box box_around_parts(const sonject_box *highlight, const sonject_box *shadow);

/* A set of pixels that are connected by their sides. */
struct contact_area {
    sonject_box box; /* around all pixels; rows 0: there is no area */
    size_t pixels;
    double energy; /* sum of intensities */
};

struct contact_image {
    const float *intensity; /* rows x columns, borrowed */
    size_t rows, columns;
    /* The seabed's first column in each row; owned. Columns before it hold a sidescan's water
     * column and its first return, which are no contacts. All are 0 if there is no water column. */
    size_t *seabed_columns;
    float *means;                      /* over 3 x 3 pixels; owned */
    uint8_t *marks;                    /* enum contact_part of the contact measured last; owned */
    sonject_box marked;                /* box outside of which marks are 0 */
    uint8_t *taken;                    /* not 0 in all contacts measured so far; owned */
    struct speckle_statistics speckle; /* statistics of all pixels */
};

/* Creates a contact image. The intensities must outlive that image. The caller gives the image to
 * contact_image_clear, also after failure. Errors: MEMORY. */
sonject_status contact_image_create(struct contact_image *image, struct report *report,
                                    const float *intensity, size_t rows, size_t columns);
void contact_image_clear(struct contact_image *image);

/* Finds the mean intensity around a box, or within it if there is nothing around it. The median of
 * blocks leaves out stones and shadows. Errors: MEMORY. */
sonject_status find_seabed_level(const struct contact_image *image, struct report *report,
                                 const sonject_box *box, double *level);

/* The place at which a contact is looked for. */
struct contact_place {
    sonject_box box;    /* holds all of the contact */
    sonject_box bright; /* part of the box that holds the highlight */
    bool is_near; /* the shadow begins just behind the highlight; farther dark areas are others' */
};

/* Marks the contact's parts in the image and clears the marks of other contacts. The highlight is
 * the area of most energy and the areas near it. The shadow is the largest dark area in the
 * highlight's rows that reaches beyond its near edge. Either may be empty. Errors: MEMORY. */
sonject_status find_contact_parts(struct contact_image *image, struct report *report,
                                  const struct contact_place *place, double seabed,
                                  struct contact_area *highlight, struct contact_area *shadow);

/* Marks the highlight alone, brighter than some least mean. Its marks do not count as taken.
 * Errors: MEMORY. */
sonject_status find_contact_highlight(struct contact_image *image, struct report *report,
                                      const struct contact_place *place, double least,
                                      struct contact_area *highlight);

struct contact_length {
    double pixels, error; /* error: standard error. NaN: no such part */
};

struct contact_sizes {
    struct contact_area highlight, shadow;
    double seabed; /* mean intensity around the box */
    struct contact_length highlight_rows, highlight_columns;
    struct contact_length shadow_rows, shadow_columns;
    struct contact_length gap_columns; /* between the highlight's far edge and the shadow */
    struct contact_length
        dim_columns; /* first columns of the shadow that are brighter than the rest; 0: none */
    double highlight_intensity,
        shadow_intensity; /* means: of the highlight's pixels; of the shadow's darkest third of
                             columns in its middle third of rows */
};

/* Measures the contact that find_contact_parts finds. A length across the track is that of the
 * middle third of the part's rows. Along the track the whole highlight counts, and the darkest
 * third of the shadow's columns. Errors: INPUT (no intensity above 0 around the box), MEMORY. */
sonject_status measure_contact_sizes(struct contact_image *image, struct report *report,
                                     const struct contact_place *place,
                                     struct contact_sizes *sizes);

/* dB; NaN: no such part, or too little seabed around it. */
struct contact_visibility {
    double
        highlight_db; /* brightest mean of 3 x 3 pixels over the 99.5 % quantile of the seabed's */
    double shadow_db; /* darkest mean of 3 x 7 pixels over the 0.5 % quantile of the seabed's */
};

/* Measures how well the parts in these boxes (rows 0: no such part) stand out of the seabed. Pixels
 * within SEABED_MARGIN of the boxes that are not taken are seabed. Errors: MEMORY. */
sonject_status measure_visibility(const struct contact_image *image, struct report *report,
                                  const sonject_box *highlight, const sonject_box *shadow,
                                  struct contact_visibility *visibility);

#endif
