/* The element level of a patch: its impulses, traced as for the image, heard by hydrophones. */
#ifndef SONJECT_INJECT_ELEMENT_ECHOES_H
#define SONJECT_INJECT_ELEMENT_ECHOES_H

#include <sonject/elements.h>

#include "inject/injection.h"

/* Fills *layout (not its struct_size) for a patch of the input's size; pixels are not used. Errors:
 * INPUT, MEMORY. */
sonject_status element_echoes_describe(struct report *report, const struct scene *scene,
                                       const struct injection_input *input,
                                       sonject_element_layout *layout);

/* Traces, and fills series: element_plan_samples values of the layout, pairs in base band. Progress
 * fractions run from 0 to 1. Errors: as sonject_element_series. */
sonject_status element_echoes_compute(struct report *report, struct device *device,
                                      const struct scene *scene,
                                      const struct injection_input *input,
                                      sonject_progress_function progress, void *user,
                                      const sonject_element_layout *layout, float *series);

#endif
