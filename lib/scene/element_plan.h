/* The array of the element level on a patch, with every default filled in. */
#ifndef SONJECT_SCENE_ELEMENT_PLAN_H
#define SONJECT_SCENE_ELEMENT_PLAN_H

#include <sonject/elements.h>

#include "scene/patch_view.h"
#include "scene/point_response.h"

/* Fills *layout, except struct_size. view, response: of the patch. Errors: INPUT (aspects beyond
 * end-fire, an empty window, series too long to address). */
sonject_status element_plan(sonject_element_layout *layout, struct report *report,
                            const struct scene *scene, const struct patch_view *view,
                            const struct point_response *response);

/* Returns the lowest sampling rate for a band, Hz. */
double element_least_rate(const sonject_elements_params *elements, double frequency_hz,
                          double bandwidth_hz);

/* Returns the number of values of all series: samples x hydrophones x pings. */
size_t element_plan_samples(const sonject_element_layout *layout);

/* Return along-track positions in the image's axis, m. */
double element_transmitter_m(const sonject_elements_params *elements, uint32_t ping);
double element_hydrophone_m(const sonject_elements_params *elements, uint32_t ping,
                            uint32_t hydrophone);

#endif
