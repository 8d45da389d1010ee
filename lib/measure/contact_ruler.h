/* How long and wide a contact's highlight and shadow are, the same for measured and injected ones.
 * What names mean: sonject/measure.h.
 *
 * Where the formulas come from:
 * - Speckle is circular Gaussian: a mean of n independent intensities has the gamma distribution of
 *   shape n (Goodman, Speckle Phenomena in Optics, section 3.3). n are the looks and pixels of a
 *   line over the correlation's sum, sqrt(pi) lengths where that falls to 1/e as a Gaussian.
 * - Edges are the mean of their likelihood, and its deviation is their error (contact_edges.h).
 * - The point response: speckle's correlation is that of its amplitude with itself, squared; a
 *   Gaussian's energy then has half the deviation of the length at which it falls to 1/e. Other
 *   responses are taken for one. 1/(2 pi^2 x^2) is the mean of sinc^2 over one of its side lobes.
 * - A shadow has two levels if those are e^10 times as likely as one: by chance once in some 200
 *   shadows of 100 pixels.
 * Thresholds are conventions, not physics: those of contact_mask.h, and of a shadow's near edge the
 * geometric mean of its own level and the seabed's. */
#ifndef SONJECT_MEASURE_CONTACT_RULER_H
#define SONJECT_MEASURE_CONTACT_RULER_H

#include "measure/contact_parts.h"

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

#endif
