/* How long and wide a contact's highlight and shadow are, the same for measured and injected ones.
 */
#ifndef SONJECT_IMAGE_CONTACT_RULER_H
#define SONJECT_IMAGE_CONTACT_RULER_H

#include "image/contact_mask.h"

/* Lengths in pixels, edges to fractions of one; NaN where there is no such part. */
struct contact_sizes {
    struct contact_area highlight, shadow;
    double seabed; /* mean intensity around the box */
    double highlight_rows, highlight_columns;
    double shadow_rows, shadow_columns;
    double highlight_intensity, shadow_intensity; /* means over their pixels */
};

/* Measures what box holds: a highlight and beyond it, within the same rows, a shadow. marks:
 * rows x columns, gets enum contact_part. Edges lie where means pass 0.6 of the seabed's
 * for a shadow, and 0.15 of the way from that to the highlight's: along the track across the part's
 * columns, in range across the middle third of its rows, both laid along the highlight if that lies
 * askew. Errors: INPUT (no intensity above 0 around the box), MEMORY. */
sonject_status measure_contact_sizes(struct report *report, const float *intensity, size_t rows,
                                     size_t columns, const struct window_box *box, uint8_t *marks,
                                     struct contact_sizes *sizes);

#endif
