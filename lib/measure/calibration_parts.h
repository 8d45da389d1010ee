/* The parts of a calibration that follow once the curve is known: response, noise floor, water
 * column, and gain over range. */
#ifndef SONJECT_MEASURE_CALIBRATION_PARTS_H
#define SONJECT_MEASURE_CALIBRATION_PARTS_H

#include "measure/calibration.h"

/* Returns the stored number that the curve takes for 1. */
double curve_full_scale(const struct calibration *calibration, const struct stored_swath *swath);

/* Returns the log intensity of a stored number by the calibration's curve, but for a constant. A
 * stored 0 counts as half a step. */
double pixel_log_intensity(const struct calibration *calibration, const struct stored_swath *swath,
                           double value);

/* Finds the water column with what follows from it, and the speckle's grain. Errors: MEMORY. */
sonject_status find_water_and_grain(struct report *report, struct calibration *found,
                                    const struct stored_swath *swath);

/* Finds the other parts. Errors: MEMORY. */
sonject_status find_parts(struct report *report, struct calibration *found,
                          const struct stored_swath *swath);

#endif
