/* Which pixels are a contact's highlight and shadow. */
#ifndef SONJECT_IMAGE_CONTACT_PARTS_H
#define SONJECT_IMAGE_CONTACT_PARTS_H

#include "image/contact_image.h"

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
