/* The aspects that a synthetic aperture integrates seabed and rough surfaces over, as the rough
 * part's fan has them (kernels/aspects.h). */
#ifndef SONJECT_TRACE_ASPECTS_H
#define SONJECT_TRACE_ASPECTS_H

#include "trace/tracer.h"

/* Sine of the largest angle off broadside; 0: broadside alone. The response's own, wavelength /
 * (4 resolution), is taken to at most 45 degrees. */
double aspects_sine(const struct tracer *tracer);

/* Fills fan->aspects but for the strips; a fan of broadside rays keeps its zeros. */
void aspects_record_init(struct fan_record *fan, const struct tracer *tracer,
                         const struct line_grid *grid);

/* How far, m along the track, a ray of the largest angle moves over a range of length_m. */
double aspects_slide(const struct tracer *tracer, double length_m);

/* Strips beyond those whose seabed is wanted, on each side, from which rays may come to it: 0 over
 * the plane. */
int32_t aspects_relief_halo(const struct tracer *tracer, const struct line_grid *grid);

#endif
