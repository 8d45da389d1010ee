/* Contacts of an image whose intensities are at hand. */
#ifndef SONJECT_API_CONTACTS_H
#define SONJECT_API_CONTACTS_H

#include <sonject/measure.h>

#include "base/report.h"
#include "measure/contacts.h"

/* All but the seabed's speckle. Errors: INPUT, MEMORY. */
sonject_status contact_measure(struct report *report, struct contact_image *image,
                               const struct contact_place *place, double row_spacing_m,
                               double column_spacing_m, sonject_contact_measures *measures);

/* The seabed's speckle in all that no contact was found in so far, for so many contacts. Errors:
 * MEMORY. */
sonject_status contacts_add_seabed(struct report *report, const struct contact_image *image,
                                   sonject_contact_measures *measures, size_t count);

/* A box of the image, in which all of a contact is. Errors: INPUT (it is not inside). */
sonject_status place_in_box(struct report *report, const sonject_box *box, size_t rows,
                            size_t columns, struct contact_place *place);

/* Errors: INPUT: not 0...1000 km. */
sonject_status check_spacings(struct report *report, double row_spacing_m, double column_spacing_m);

/* Intensities of a caller's pixels, for free(), after failure as well. Errors: ARGUMENT, INPUT,
 * MEMORY. */
sonject_status take_intensities(struct report *report, const sonject_pixels *pixels, size_t *rows,
                                size_t *columns, float **intensity);

/* What of a file is measured, as of swath_file_open_beside. */
struct measured_image {
    const char *path;
    const char *other; /* NULL: none */
    int32_t channel;
    const char *array;
};

/* Those of a whole image. transfer: how amplitudes became stored numbers. Errors: INPUT, STORAGE,
 * MEMORY, UNSUPPORTED. */
sonject_status read_intensities(struct report *report, const struct measured_image *image,
                                const sonject_transfer_params *transfer, size_t *rows,
                                size_t *columns, float **intensity);

/* A member of sonject_contact_measures that is a number. */
struct contact_number {
    const char *name;
    size_t offset;
};

#define CONTACT_NUMBERS  30
#define COMPARED_NUMBERS 24 /* the first ones: the others are standard errors */

extern const struct contact_number contact_numbers[CONTACT_NUMBERS];

#endif
