/* What of lines is worth forming: glints of clutter lie in few places of large grids, and zeros add
 * nothing. */
#ifndef SONJECT_FORM_FILLED_STRIPS_H
#define SONJECT_FORM_FILLED_STRIPS_H

#include <stdbool.h>
#include <stddef.h>

#include "kernels/layout.h"
#include "scene/line_grid.h"

bool filled_span_is_empty(struct filled_span span);

/* The bins of a line with anything but zeros in one of its parts. imaginary_part may be NULL. */
struct filled_span filled_span_of(const float *real_part, const float *imaginary_part, size_t bins);

/* The next run of strips after another, which at first is {0, 0}: it begins and ends with filled
 * strips, and holds gaps that cost less to form than to leave out. count 0 after the last. */
struct span next_filled_strips(const struct filled_span *filled, int32_t count, struct span before);

#endif
