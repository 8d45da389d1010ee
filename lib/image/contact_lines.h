/* Lines through a contact, laid along its highlight, and their mean intensities. */
#ifndef SONJECT_IMAGE_CONTACT_LINES_H
#define SONJECT_IMAGE_CONTACT_LINES_H

#include "image/contact_edges.h"
#include "image/contact_parts.h"

/* How lines lie. Columns of boxes that are used with it count along row middle_row: in a row
 * further on they lie slant more to the right, in one of a tilted edge as much more as it is
 * tilted. */
struct contact_lines {
    const struct contact_image *image;
    double seabed; /* mean intensity */
    double slant, middle_row;
    double tilt, tilt_row;
    double *means, *skirt; /* room for one profile; owned */
};

/* Errors: MEMORY. To be given to contact_lines_clear, after failure as well. */
sonject_status contact_lines_create(struct contact_lines *lines, struct report *report,
                                    const struct contact_image *image);
void contact_lines_clear(struct contact_lines *lines);

/* How many columns further to the right lines lie in a row. */
long line_shift(const struct contact_lines *lines, size_t row);

/* Of the pixels of the box that are inside the image; the seabed's where none is. */
double mean_along_lines(const struct contact_lines *lines, const struct window_box *box);

/* Rows of a box, or columns, one after the other from `start`, backwards where step is -1. */
struct profile_path {
    struct window_box box;
    bool is_along_track; /* row after row */
    size_t start;
    int step;
    size_t most; /* at most so many, and none beyond the image's edge */
};

/* Their mean intensities, valid until the next call; without and with the skirt of the pixels that
 * are marked as highlight: side lobes along the track, as of an aperture without a window. */
struct profile profile_along(const struct contact_lines *lines, const struct profile_path *path);
struct profile profile_with_skirt(const struct contact_lines *lines,
                                  const struct profile_path *path);

#endif
