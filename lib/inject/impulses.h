/* What tracing leaves for image formation: lines of bins on fine grids. */
#ifndef SONJECT_INJECT_IMPULSES_H
#define SONJECT_INJECT_IMPULSES_H

#include <stdint.h>

#include <sonject/status.h>

#include "scene/patch_view.h"

/* Sets of lines, in the order in which they are handed out. */
enum impulse_kind {
    IMPULSES_SEABED, /* m^2: what the seabed returns without objects and, where its realisation is
                        wanted, a second plane: what is in view of it */
    IMPULSES_OBJECT, /* one set for each object: the planes of its tile (kernels/layout.h), energy
                        and lost energy in m^2, footprint in rays; no cells: none of it is seen */
    IMPULSES_GLINT,  /* after their object, one set for each of its parts that has some: real and
                        imaginary part, m */
    IMPULSES_BEAM,   /* m^2: what each ping hears of an even seabed; only of a real aperture */
    IMPULSES_HIDDEN, /* m^2: of that, what an object hides; one set for each after BEAM */
    IMPULSES_LEVEL, /* m^2: as the seabed, without objects and relief; only where there is relief */
    IMPULSES_CHAINS /* m^2: of paths of several interactions; a set for each order, or one for all
                     */
};

#define IMPULSE_KINDS      7
#define IMPULSE_PLANES_MAX 3

/* Some strips of a set. Sets come strip by strip from their first to their last; those of objects,
 * of what they hide and of chains in one piece. */
struct impulse_lines {
    enum impulse_kind kind;
    uint32_t number;       /* of object or part; of CHAINS, interactions of the shortest path */
    struct line_grid grid; /* of the whole set */
    struct span strips;    /* these */
    uint32_t planes;
    const float *plane[IMPULSE_PLANES_MAX]; /* strips.count x grid.bins.count each */
};

/* Who takes them: the former of an image, or the writer of a file. */
struct impulse_sink {
    sonject_status (*take)(void *taker, const struct impulse_lines *lines);
    void *taker;
};

struct tracer;
struct echo_request;

/* Where they come from: rays, or a file. */
struct impulse_source {
    /* Hands out all sets. Errors: of the source, and the sink's own. */
    sonject_status (*deliver)(void *giver, struct tracer *tracer,
                              const struct echo_request *request, const struct impulse_sink *sink);
    void *giver;
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

#endif
