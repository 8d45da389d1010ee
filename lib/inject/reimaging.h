/* Whether impulses that were traced for one pulse and cross-range response give an image with
 * another. */
#ifndef SONJECT_INJECT_REIMAGING_H
#define SONJECT_INJECT_REIMAGING_H

#include "scene/patch_view.h"
#include "trace/tracer.h"

/* Whether the tracer's response can be formed on the seabed's grid of a file: strips and bins fine
 * enough, and margins wide enough that a pixel at the patch's edge lacks at most 2 % of its energy.
 * file: for the message. Errors: INPUT (names the smallest and the largest that will do; a grid
 * that does not hold the patch). */
sonject_status reimaging_check_patch(const struct line_grid *grid, const struct tracer *tracer,
                                     const char *file);

/* The same of a part's glints, whose bins are finer. */
sonject_status reimaging_check_glints(const struct line_grid *grid, const struct tracer *tracer,
                                      const char *file);

/* Lines of single pings, which are not spread along the track: whether they hold the patch. */
sonject_status reimaging_check_beam(const struct line_grid *grid, const struct tracer *tracer,
                                    const char *file);

#endif
