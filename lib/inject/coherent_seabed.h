/* The seabed as a measured complex reflectivity: its own phases instead of new speckle. */
#ifndef SONJECT_INJECT_COHERENT_SEABED_H
#define SONJECT_INJECT_COHERENT_SEABED_H

#include "trace/tracer.h"

/* Turns the energies of a chunk of strips (strips.count x bins) into complex amplitudes: sqrt of
 * energy times the reflectivity of the bin's pixel (rows x columns of the view, unit mean square),
 * scaled so that the image's mean energy stays what speckle would give. In place in `energy`; the
 * imaginary part goes to `imaginary_part`. */
void coherent_seabed_lines(const struct line_grid *grid, const struct tracer *tracer,
                           struct span strips, const float *reflectivity_real,
                           const float *reflectivity_imaginary, float *energy,
                           float *imaginary_part);

#endif
