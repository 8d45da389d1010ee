/* Impulses and elements as the device counts them. */
#ifndef SONJECT_ELEMENTS_SERIES_RECORDS_H
#define SONJECT_ELEMENTS_SERIES_RECORDS_H

#include "elements/fine_pulse.h"
#include "elements/impulse_list.h"
#include "kernels/element_series_records.h"

/* A piece's strips and bins, and how its echoes become fine samples; segments: work-items that
 * share a line. */
struct impulse_grid_record impulse_grid_record_of(const sonject_element_layout *layout,
                                                  const struct patch_view *view,
                                                  const struct impulse_piece *piece,
                                                  const struct fine_pulse *pulse, int32_t segments);

/* Pairs first...first + count - 1 of transmitter and hydrophone, hydrophones of a ping one after
 * the other, on the numbering of a piece's strips. */
void element_pair_records_fill(struct element_pair_record *records,
                               const sonject_elements_params *elements,
                               const struct patch_view *view, const struct impulse_piece *piece,
                               size_t first, size_t count);

#endif
