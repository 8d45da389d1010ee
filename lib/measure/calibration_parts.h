/* The parts of a calibration that follow once the curve is known: response, noise floor, water
 * column, gain against range. */
#ifndef SONJECT_MEASURE_CALIBRATION_PARTS_H
#define SONJECT_MEASURE_CALIBRATION_PARTS_H

#include "measure/calibration.h"

/* Full scale that the curve counts from. */
double curve_full_scale(const struct calibration *calibration, const struct stored_swath *swath);

/* Log intensity of a stored number by the calibration's curve, but for a constant; what is stored
 * as 0 counts as half a step. */
double pixel_log_intensity(const struct calibration *calibration, const struct stored_swath *swath,
                           double value);

/* The water column, and what it tells. Errors: MEMORY. */
sonject_status find_water(struct report *report, struct calibration *found,
                          const struct stored_swath *swath);

/* All the others. Errors: MEMORY. */
sonject_status find_parts(struct report *report, struct calibration *found,
                          const struct stored_swath *swath);

#endif
