/* Contacts in an image of intensities: looked for, told apart into highlight and shadow, and
 * measured, the same for measured and injected ones. What names of measures mean:
 * sonject/measure.h. */
#ifndef SONJECT_MEASURE_CONTACTS_H
#define SONJECT_MEASURE_CONTACTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <sonject/result.h>

#include "base/report.h"
#include "image/statistics.h"

#define HIGHLIGHT_OVER_SEABED 4.0  /* mean of 3 x 3 pixels: 6 dB over the seabed */
#define HIGHLIGHT_UNDER_PEAK  0.01 /* side lobes of bright echoes are not the contact */
#define SHADOW_UNDER_SEABED   0.25
#define SEABED_MARGIN         24 /* pixels around a box that are taken for seabed */
#define CONTACT_MARGIN        6  /* pixels around highlight and shadow in a contact's box */
#define PIECE_GAP             6  /* pixels between pieces of one highlight, at most */
#define PIECES_MAX            32 /* beside the first */

enum contact_part {
    PART_NONE,
    PART_HIGHLIGHT,
    PART_SHADOW
};

/* A rectangle of an image of intensities. */
struct window_box {
    size_t first_row, first_column, rows, columns;
};

struct window_box window_box_of(const sonject_box *box);

/* For qsort: the smallest first. */
int compare_floats(const void *a, const void *b);

/* The box with so many pixels around it, within the image. */
struct window_box box_with_margin(const struct window_box *box, size_t margin, size_t rows,
                                  size_t columns);

/* The smallest box around both. */
struct window_box box_around(const struct window_box *a, const struct window_box *b);
bool boxes_overlap(const struct window_box *a, const struct window_box *b);

/* A connected set of pixels (by sides). */
struct contact_area {
    struct window_box box; /* around it; rows 0: there is none */
    size_t pixels;
    double energy; /* sum of intensities */
};

struct contact_image {
    const float *intensity; /* rows x columns, borrowed */
    size_t rows, columns;
    /* The seabed's first column in each row, behind the water column of a sidescan image and before
     * its first return, which are no contacts; all 0 where there is none; owned. */
    size_t *seabed_columns;
    float *means;                      /* over 3 x 3 pixels; owned */
    uint8_t *marks;                    /* enum contact_part, of the contact measured last; owned */
    struct window_box marked;          /* beyond which marks are 0 */
    uint8_t *taken;                    /* not 0: of any contact measured so far; owned */
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

struct contact_length {
    double pixels, error; /* error: standard, of speckle alone. NaN where there is no such part */
};

struct contact_sizes {
    struct contact_area highlight, shadow;
    double seabed; /* mean intensity around the box */
    struct contact_length highlight_rows, highlight_columns;
    struct contact_length shadow_rows, shadow_columns;
    struct contact_length gap_columns; /* from the highlight's far edge to the shadow */
    struct contact_length
        dim_columns; /* of the shadow's, the first ones if brighter; 0: none are */
    double highlight_intensity, shadow_intensity; /* means: over its pixels, and over the darkest
                                                     third of its columns in the middle third of its
                                                     rows, which its edges are not in */
};

/* Measures the contact that find_contact_parts finds. Across the track lengths are those of the
 * middle third of the part's rows, along it the whole highlight's, and of the shadow those across
 * its darkest third of columns. Errors: INPUT (no intensity above 0 around the box), MEMORY. */
sonject_status measure_contact_sizes(struct contact_image *image, struct report *report,
                                     const struct contact_place *place,
                                     struct contact_sizes *sizes);

/* dB; NaN: no such part, or too little seabed about it. */
struct contact_visibility {
    double highlight_db; /* its brightest mean of 3 x 3 pixels over the 99.5 % quantile of equal
                            means of seabed */
    double shadow_db;    /* its darkest mean of 3 rows and 7 columns over the 0.5 % quantile */
};

/* How well the parts in these boxes (rows 0: there is none) can be seen amid the seabed within
 * SEABED_MARGIN of them, which is what is not taken. Errors: MEMORY. */
sonject_status measure_visibility(const struct contact_image *image, struct report *report,
                                  const struct window_box *highlight,
                                  const struct window_box *shadow,
                                  struct contact_visibility *visibility);

/* A connected area that is HIGHLIGHT_OVER_SEABED and more over the seabed around it. */
struct bright_area {
    struct window_box box;
    double contrast; /* of its brightest mean of 3 x 3 pixels over the seabed */
};

struct found_contact {
    struct contact_place place;
    double contrast;
};

struct contact_search {
    struct bright_area *areas; /* the brightest first, then by row and column; owned */
    size_t count, next;
    struct found_contact *found; /* so far; owned */
    size_t found_count;
};

/* Lists the bright areas of an image. Errors: MEMORY. To be given to contact_search_clear, after
 * failure as well. */
sonject_status contact_search_begin(struct contact_search *search, struct report *report,
                                    const struct contact_image *image);
void contact_search_clear(struct contact_search *search);

/* Goes on to the next contact whose contrast is at least that, which touches the box of none found
 * before, is not fainter than HIGHLIGHT_UNDER_PEAK of one that lies in its columns some rows away,
 * as side lobes are, and has a seabed around it. *place: with a margin around highlight and shadow;
 * no rows: there are no more. Errors: MEMORY. */
sonject_status contact_search_next(struct contact_search *search, struct report *report,
                                   struct contact_image *image, double contrast,
                                   struct contact_place *place);

/* Of the areas not yet come to, how many are that bright and belong to no contact found so far. */
size_t contact_search_left(const struct contact_search *search, const struct contact_image *image,
                           double contrast);

#endif
