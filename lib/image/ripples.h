/* Sand ripples: crests that wander, fork and end, and how strongly their two faces scatter. */
#ifndef SONJECT_IMAGE_RIPPLES_H
#define SONJECT_IMAGE_RIPPLES_H

#include <sonject/image.h>

#include "base/report.h"

struct ripples;

/* Uses streams from `stream` on. *ripples is for ripples_release, on failure NULL. Errors: MEMORY.
 */
sonject_status ripples_create(struct report *report, const sonject_synthetic_params *synthetic,
                              const sonject_geometry_params *geometry, uint32_t stream,
                              struct ripples **ripples);

void ripples_release(struct ripples **ripples);

/* Multiplies the next row of intensities by the ripples' modulation, whose mean is 1 whatever
 * presence (0...1 for each column: the share of the full contrast that ripples have there). */
void ripples_modulate_next_row(struct ripples *ripples, const float *presence, float *intensity);

#endif
