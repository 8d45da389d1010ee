/* What tracing leaves for image formation: lines of bins on fine grids. */
#ifndef SONJECT_INJECT_IMPULSES_H
#define SONJECT_INJECT_IMPULSES_H

#include <stdint.h>

#include <sonject/status.h>

#include "scene/patch_view.h"
#include "trace/tracer.h"

/* Sets of lines, in the order in which they are handed out. */
enum impulse_kind {
    IMPULSES_SEABED, /* m^2: what the seabed returns without objects and, where its realisation is
                        wanted, a second plane: what is in view of it */
    IMPULSES_OBJECT, /* one set for each object: the planes of its tile (kernels/layout.h), energy
                        and lost energy in m^2, footprint in rays; no cells: none of it is seen */
    IMPULSES_GLINT,  /* after their object, one set for each of its parts that has some: real and
                        imaginary part, m */
    IMPULSES_MULTIBOUNCE, /* after the object's glints, which they interfere with: echoes of several
                             smooth faces, a set for each region where they gather, m */
    IMPULSES_BEAM,        /* m^2: what each ping hears of an even seabed; only of a real aperture */
    IMPULSES_HIDDEN,      /* m^2: of that, what an object hides; one set for each after BEAM */
    IMPULSES_LEVEL, /* m^2: as the seabed, without objects and relief; only where there is relief */
    IMPULSES_CHAINS /* m^2: of paths of several interactions; a set for each order */
};

#define IMPULSE_KINDS      8
#define IMPULSE_PLANES_MAX 3

/* Some strips of a set. Sets come strip by strip from their first to their last; those of objects,
 * of what they hide and of chains in one piece. */
struct impulse_lines {
    enum impulse_kind kind;
    uint32_t number;       /* of object, part, or region, counted over all objects; of CHAINS,
                              interactions of the shortest path */
    struct line_grid grid; /* of the whole set */
    struct span strips;    /* these */
    uint32_t planes;
    const float *plane[IMPULSE_PLANES_MAX]; /* strips.count x grid.bins.count each */
};

/* Who takes them: the former of an image or of series. */
struct impulse_sink {
    sonject_status (*take)(void *taker, const struct impulse_lines *lines);
    void *taker;
};

/* Whether these are the first, or the last, of their set. */
static inline int impulse_lines_begin(const struct impulse_lines *lines)
{
    return lines->strips.first == lines->grid.strips.first;
}

static inline int impulse_lines_end(const struct impulse_lines *lines)
{
    return lines->strips.first + lines->strips.count ==
           lines->grid.strips.first + lines->grid.strips.count;
}

struct echo_request;
struct injection_input;

/* By rays: traces everything that the request asks for, and hands it on as it comes, unless the
 * sink is NULL, so that only a checkpoint keeps it. Errors: INPUT, DEVICE, MEMORY, CANCELLED, and
 * the sink's own. */
sonject_status trace_impulses(struct tracer *tracer, const struct echo_request *request,
                              const struct impulse_sink *sink);

/* Whether impulses that `traced` lays the grids of can be formed with the tracer's response: bins,
 * strips and margins must be fine and wide enough. Errors: INPUT. */
sonject_status check_response_fits(const struct tracer *tracer, const struct tracer *traced);

#endif
