/* The parts that the rays of a launch aimed at one of them can meet: of much clutter, only what
 * lies in the way. */
#ifndef SONJECT_TRACE_LAUNCH_PARTS_H
#define SONJECT_TRACE_LAUNCH_PARTS_H

#include <stdbool.h>

#include "trace/tracer.h"

struct launch_parts {
    uint32_t *numbers; /* of the scene's parts, ascending; owned */
    uint32_t count;
    uint32_t target; /* index of the part that is aimed at */
};

/* All rays stay in planes across the track on the grid's strips. is_straight: they also stay in the
 * elevations of the part as seen from the sonar, and what lies behind it does not matter. Few parts
 * are all listed. Errors: MEMORY. */
sonject_status launch_parts_init(struct launch_parts *parts, const struct tracer *tracer,
                                 uint32_t target, const struct line_grid *grid, bool is_straight);
void launch_parts_clear(struct launch_parts *parts);

/* Objects of a launch: records of its parts in a frame; tiles left 0. */
sonject_status launch_records_create(struct object_record **records, const struct tracer *tracer,
                                     const struct launch_parts *parts, const double origin[3]);

#endif
