/* Contacts that are looked for in an image: bright areas, and the shadows behind them. */
#ifndef SONJECT_MEASURE_CONTACT_SEARCH_H
#define SONJECT_MEASURE_CONTACT_SEARCH_H

#include "measure/contact_parts.h"

#define CONTACT_MARGIN 6 /* pixels around highlight and shadow in a contact's box */

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
