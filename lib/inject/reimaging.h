/* Whether impulses that were traced for one pulse and cross-range response give an image with
 * another. */
#ifndef SONJECT_INJECT_REIMAGING_H
#define SONJECT_INJECT_REIMAGING_H

#include "scene/line_grid.h"
#include "trace/tracer.h"

/* The grids that tracing lays. */
struct traced_grids {
    struct line_grid patch;
    struct line_grid glints; /* of which only strips_per_row and bins_per_pixel hold for all */
};

/* Gives the grids that were laid for the response of `traced`, the scene with the sonar that it
 * then had, and says whether the tracer's own response can be formed on them: bins and strips fine
 * enough, and margins wide enough that a pixel at the patch's edge lacks at most 2 % of its energy.
 * file: for the message. Errors: INPUT (names the smallest and the largest that will do). */
sonject_status reimaging_check(struct traced_grids *grids, const struct tracer *tracer,
                               const struct scene *traced, const char *file);

#endif
