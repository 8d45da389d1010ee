/* The measures of images and their contacts, as the public functions report them. */
#ifndef SONJECT_MEASURE_MEASURES_H
#define SONJECT_MEASURE_MEASURES_H

#include <sonject/measure.h>

#include "base/report.h"
#include "measure/contacts.h"
#include "scene/params.h"

#define BOXES_MAX 100000 /* most contacts that are measured at once */

/* Checks that both spacings are 0...1000 km. Errors: INPUT. */
sonject_status check_spacings(struct report *report, double row_spacing_m, double column_spacing_m);

/* An image to measure: planes of rows x columns; owned. */
struct measured {
    size_t rows, columns;
    float *amplitudes;
    uint8_t *labels;                        /* not 0: no seabed; NULL: unknown */
    double row_spacing_m, column_spacing_m; /* the file's, for slant range; 0: none */
};
void measured_clear(struct measured *measured);

/* Squares the amplitudes to intensities. Errors: INPUT. */
sonject_status measured_square(struct report *report, struct measured *measured);

/* Measures the image's seabed. Its amplitudes become intensities. Errors: INPUT, MEMORY. */
sonject_status measure_amplitudes(struct report *report, struct measured *measured,
                                  sonject_measurement *measurement);

/* Measures the seabed of a file: sonject_measure. */
sonject_status measure_file(struct report *report, const sonject_measure_params *params,
                            const struct image_options *options, sonject_measurement *measurement);

/* Reports that a pixel, of `columns` in a row, is a negative amplitude. Returns INPUT. */
sonject_status negative_amplitude(struct report *report, const char *what, size_t at,
                                  size_t columns);

/* Reads the file's amplitudes. measured: all zeros. Errors: INPUT, STORAGE, MEMORY, UNSUPPORTED. */
sonject_status read_amplitudes(struct report *report, const sonject_measure_params *params,
                               const struct image_options *options, struct measured *measured);

/* Measures contacts of intensities as JSON: sonject_measure_contacts. Parameters must have no zeros
 * left that stand for defaults. intensities: mirrored where range grows to the left. */
sonject_status measure_listed_contacts(struct report *report, const sonject_measure_params *params,
                                       struct measured *intensities, char **text);

/* Measures one contact of intensities: sonject_measure_contact. */
sonject_status measure_one_contact(struct report *report, const float *intensity, size_t rows,
                                   size_t columns, const sonject_box *box, double row_spacing_m,
                                   double column_spacing_m, sonject_contact_measures *found);

/* Measures one contact whose place is known. The place's boxes are inside the image. */
sonject_status measure_placed_contact(struct report *report, const float *intensity, size_t rows,
                                      size_t columns, const struct contact_place *place,
                                      double row_spacing_m, double column_spacing_m,
                                      sonject_contact_measures *found);

/* A member of sonject_contact_measures that is a number. */
struct contact_number {
    const char *name;
    size_t offset;
};

#define CONTACT_NUMBERS 32

extern const struct contact_number contact_numbers[CONTACT_NUMBERS];

#endif
