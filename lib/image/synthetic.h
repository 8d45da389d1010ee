/* Synthetic seabeds. */
#ifndef SONJECT_IMAGE_SYNTHETIC_H
#define SONJECT_IMAGE_SYNTHETIC_H

#include <sonject/image.h>

#include "base/report.h"

/* Fills pixels (rows x columns amplitudes, or complex values as pairs of floats) with a seabed: the
 * same bits for the same parameters on every machine. along_track_resolution_m: first zero of the
 * sinc response; range_resolution_m: half-power width of the Gaussian response. Errors: MEMORY. */
sonject_status synthesise_seabed(struct report *report, const sonject_synthetic_params *synthetic,
                                 const sonject_geometry_params *geometry,
                                 double along_track_resolution_m, double range_resolution_m,
                                 float *pixels);

#endif
