/* Impulses, which tracing hands to image formation: lines of bins on fine grids. A line is the bins
 * of one strip; strips divide rows and bins divide columns (struct line_grid). */
#ifndef SONJECT_INJECT_IMPULSES_H
#define SONJECT_INJECT_IMPULSES_H

#include <stdint.h>

#include <sonject/status.h>

#include "scene/patch_view.h"
#include "trace/tracer.h"

/* The sets of lines, in the order in which they are handed out. */
enum impulse_kind {
    IMPULSES_SEABED, /* m^2: the seabed without objects and, where its realisation is wanted, a
                        second plane: the part in view */
    IMPULSES_OBJECT, /* one set for each object: the planes of its tile (kernels/layout.h), energy
                        and lost energy in m^2, footprint in rays; no cells: not in view */
    IMPULSES_GLINT,  /* after their object, one set for each of its parts that has glints: real and
                        imaginary part, m */
    IMPULSES_MULTIBOUNCE, /* after the object's glints, which they interfere with: echoes of several
                             smooth faces, a set for each region where they gather, m */
    IMPULSES_BEAM,        /* m^2: even seabed as each ping hears it; real apertures only */
    IMPULSES_HIDDEN,      /* m^2: the part of BEAM that an object hides; one set for each */
    IMPULSES_LEVEL,       /* m^2: the seabed without objects and relief; only with relief */
    IMPULSES_CHAINS       /* m^2: paths of several interactions; a set for each order */
};

#define IMPULSE_KINDS      8
#define IMPULSE_PLANES_MAX 3

/* Some strips of a set. Sets come strip by strip from their first to their last. Those of OBJECT,
 * HIDDEN and CHAINS come in one piece. */
struct impulse_lines {
    enum impulse_kind kind;
    uint32_t number; /* number of the object, part, or region, counted over all objects; CHAINS:
                        interactions of the shortest path */
    struct line_grid grid; /* grid of the whole set */
    struct span strips;    /* the strips that come */
    struct span bins; /* the bins that come; the others of the grid are empty in these strips */
    uint32_t planes;
    const float *plane[IMPULSE_PLANES_MAX]; /* strips.count x bins.count each */
};

/* The taker of impulses: the former of an image or of series. */
struct impulse_sink {
    sonject_status (*take)(void *taker, const struct impulse_lines *lines);
    void *taker;
};

/* Return whether these lines are the first, or the last, of their set. */
static inline int impulse_lines_begin(const struct impulse_lines *lines)
{
    return lines->strips.first == lines->grid.strips.first;
}

static inline int impulse_lines_end(const struct impulse_lines *lines)
{
    return lines->strips.first + lines->strips.count ==
           lines->grid.strips.first + lines->grid.strips.count;
}

/* Returns the bins that come, counted from the grid's first. */
static inline struct span impulse_lines_bins(const struct impulse_lines *lines)
{
    const struct span bins = {lines->bins.first - lines->grid.bins.first, lines->bins.count};
    return bins;
}

struct echo_request;
struct injection_input;

/* Traces all impulses that the request asks for and hands them on as they come. sink NULL: only a
 * checkpoint keeps them. Errors: INPUT, DEVICE, MEMORY, CANCELLED, and the sink's own. */
sonject_status trace_impulses(struct tracer *tracer, const struct echo_request *request,
                              const struct impulse_sink *sink);

/* Checks that impulses on the grids of `traced` can be formed with the tracer's response: bins,
 * strips and margins must be fine and wide enough. Errors: INPUT. */
sonject_status check_response_fits(const struct tracer *tracer, const struct tracer *traced);

/* Notes that impulses of shadows and rough surfaces were traced for other aspects, or for another
 * weighting of them, than those of the tracer's response. No sum over impulses can change that. */
void note_other_aspects(const struct tracer *tracer, const struct tracer *traced);

#endif
