/* What images and their contacts measure, as callers are told it. */
#ifndef SONJECT_MEASURE_MEASURES_H
#define SONJECT_MEASURE_MEASURES_H

#include <sonject/measure.h>

#include "base/report.h"
#include "measure/contacts.h"
#include "scene/params.h"

#define BOXES_MAX 100000 /* contacts that are measured at once */

/* The seam of an injection: can what was put around a target be told from untouched seabed?
 * Formulas: kernels/MATH.md, "Blending". */
struct seam {
    double auc;                 /* area under the classifier's curve: 0.5 chance, 1 certain */
    double error;               /* standard error */
    size_t patches, background; /* that were compared */
};

/* Compares patches of the band around the targets (influence not 0, not beside labels
 * not 0) with patches of the same outlines on untouched seabed near by, by a linear classifier on
 * local statistics, trained on other parts of the image than those it judges. amplitudes >= 0,
 * influence, labels (may be NULL): rows x columns. Where there are too few patches, patches tells
 * how many, and auc and error are NaN. Errors: MEMORY. */
sonject_status measure_seam(struct report *report, const float *amplitudes,
                            const uint8_t *influence, const uint8_t *labels, size_t rows,
                            size_t columns, struct seam *seam);

/* Gives the pixels of a mask that lie so near to one, along both axes, a value. */
void fill_square(uint8_t *mask, size_t rows, size_t columns, size_t at, size_t radius,
                 uint8_t value);

/* Errors: INPUT: not 0...1000 km. */
sonject_status check_spacings(struct report *report, double row_spacing_m, double column_spacing_m);

/* An image that is measured: planes of rows x columns; owned. */
struct measured {
    size_t rows, columns;
    float *amplitudes;
    float *before;                          /* amplitudes; NULL: not told */
    uint8_t *influence, *labels;            /* NULL: not told */
    double row_spacing_m, column_spacing_m; /* that its file tells, of slant range; 0: none */
};
void measured_clear(struct measured *measured);

/* Changes the amplitudes to intensities. Errors: INPUT. */
sonject_status measured_square(struct report *report, struct measured *measured);

/* The image's seabed and its seam; its amplitudes become intensities. Errors: INPUT, MEMORY. */
sonject_status measure_amplitudes(struct report *report, struct measured *measured,
                                  sonject_measurement *measurement);

/* The same of a file: sonject_measure. */
sonject_status measure_file(struct report *report, const sonject_measure_params *params,
                            const struct image_options *options, sonject_measurement *measurement);

/* Amplitudes of the file alone; measured: all zeros. Errors: INPUT, STORAGE, MEMORY, UNSUPPORTED.
 */
sonject_status read_amplitudes(struct report *report, const sonject_measure_params *params,
                               const struct image_options *options, struct measured *measured);

/* Contacts of intensities as JSON: sonject_measure_contacts. Parameters have no zeros left that
 * stand for something else. intensities: turned about where range grows to the left. */
sonject_status measure_listed_contacts(struct report *report, const sonject_measure_params *params,
                                       struct measured *intensities, char **text);

/* One contact of intensities: sonject_measure_contact. */
sonject_status measure_one_contact(struct report *report, const float *intensity, size_t rows,
                                   size_t columns, const sonject_box *box, double row_spacing_m,
                                   double column_spacing_m, sonject_contact_measures *found);

/* The same where its place is known: boxes inside the image. */
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
