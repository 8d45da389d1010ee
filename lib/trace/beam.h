/* The two-way beam of a real aperture, as the rough part's fan has it (kernels/aspects.h). */
#ifndef SONJECT_TRACE_BEAM_H
#define SONJECT_TRACE_BEAM_H

#include "trace/tracer.h"

/* Fills fan->beam, and lays the fan's rays anew so that those off broadside reach the patch's near
 * end too. fan: of patch_fan_init. Errors: INPUT (too many rays). */
sonject_status beam_record_init(struct fan_record *fan, const struct tracer *tracer,
                                const struct line_grid *grid);

/* Sine of the largest angle off broadside that the beam's rays go out to. */
double beam_largest_sine(const struct tracer *tracer);

/* The most that a ray of the beam stands for, over one of a strip. */
double beam_largest_weight(const struct tracer *tracer, const struct fan_record *fan);

#endif
