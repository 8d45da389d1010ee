/* Contacts of an image whose intensities are at hand. */
#ifndef SONJECT_API_CONTACTS_H
#define SONJECT_API_CONTACTS_H

#include <sonject/measure.h>

#include "base/report.h"

/* Intensities rows x columns. Errors: INPUT, MEMORY. */
sonject_status contact_measure(struct report *report, const float *intensity, size_t rows,
                               size_t columns, const sonject_contact_params *params,
                               sonject_contact_measures *measures);

/* Intensities of a caller's pixels, for free(), after failure as well. Errors: ARGUMENT, INPUT,
 * MEMORY. */
sonject_status take_intensities(struct report *report, const sonject_pixels *pixels, size_t *rows,
                                size_t *columns, float **intensity);

/* Those of a whole image file. transfer: how amplitudes became stored numbers. Errors: INPUT,
 * STORAGE, MEMORY, UNSUPPORTED. */
sonject_status read_intensities(struct report *report, const char *path,
                                const sonject_transfer_params *transfer, size_t *rows,
                                size_t *columns, float **intensity);

/* A member of sonject_contact_measures that is a number. */
struct contact_number {
    const char *name;
    size_t offset;
};

#define CONTACT_NUMBERS 20

extern const struct contact_number contact_numbers[CONTACT_NUMBERS];

#endif
