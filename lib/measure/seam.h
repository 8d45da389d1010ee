/* The seam of an injection: can what was put around a target be told from untouched seabed?
 * Formulas: kernels/MATH.md, "Blending". */
#ifndef SONJECT_MEASURE_SEAM_H
#define SONJECT_MEASURE_SEAM_H

#include <stdint.h>

#include "base/report.h"

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

#endif
