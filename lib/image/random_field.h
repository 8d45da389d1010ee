/* Smooth random fields, made row by row: white Gaussian numbers on a lattice, blurred along each
 * axis. Numbers come from a counter, and arithmetic is + - * / and square roots in a fixed order,
 * so a field has the same bits on every machine with IEEE arithmetic. */
#ifndef SONJECT_IMAGE_RANDOM_FIELD_H
#define SONJECT_IMAGE_RANDOM_FIELD_H

#include <stdint.h>

#include "base/report.h"

enum blur_kind {
    BLUR_GAUSSIAN,    /* exp(-x^2 / 2 width^2); autocorrelation exp(-x^2 / 4 width^2) */
    BLUR_BAND_LIMITED /* sinc(x / width), its own autocorrelation; width is the first zero */
};

/* A blur along one axis, in pixels. Widths below BLUR_SMALLEST_* count as that width: neighbouring
 * pixels are then nearly independent (correlation 0.06 and 0). */
struct blur {
    enum blur_kind kind;
    double width;
};

#define BLUR_SMALLEST_GAUSSIAN     0.3
#define BLUR_SMALLEST_BAND_LIMITED 0.5

struct random_field; /* Two independent real fields. */

/* Creates a field, which seed and stream choose. *field is for random_field_release; on failure it
 * is NULL. Errors: MEMORY. */
sonject_status random_field_create(struct report *report, uint64_t seed, uint32_t stream,
                                   uint32_t columns, struct blur along_track, struct blur range,
                                   struct random_field **field);

void random_field_release(struct random_field **field);

/* Makes the next row of both fields, standard normal, valid until the next call. The first call
 * gives row 0. There are at most 2^20 rows. */
void random_field_next_row(struct random_field *field, const float **first, const float **second);

#endif
