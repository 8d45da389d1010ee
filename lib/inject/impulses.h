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

/* Who takes them: the former of an image, or an export. */
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

/* Impulses as arrays for other programs, in HDF5; nothing is read back from it.
 *
 *   /                  attributes: sonject (version), scene (hash of all that tracing depends on),
 *                      seed, the image's path, hash, rows and columns, what the grids were laid
 *                      for, side (port or starboard), the patch in the swath, and what was counted;
 *                      units in their names
 *   /seabed            energy; in_view where the patch is resynthesised   (m^2)
 *   /objects/NUMBER    energy (m^2), footprint (rays), lost (m^2); objects count from 0
 *   /glints/PART       real, imaginary (m); parts count from 0 over all objects; only smooth ones
 *   /multibounce/REGION  real, imaginary (m): echoes of several smooth faces, by the regions that
 *                      hold them, from 0; only with several interactions
 *   /beam              energy (m^2) that each ping hears of an even seabed; only of a real aperture
 *   /hidden/NUMBER     lost (m^2): of that, what an object hides
 *   /level             energy (m^2); only with relief
 *   /chains/ORDER      energy (m^2) of paths of that many interactions, or of all from there on
 *                      where orders are not kept apart; only with several interactions
 *
 * Each set of lines has the attributes of its grid (scene/patch_view.h): strips_per_row,
 * bins_per_pixel, first_strip, strips, first_bin, bins; its datasets are strips x bins of 32-bit
 * floats with an attribute units, in chunks of whole strips of about 1 MB, shuffled and deflated.
 * Rows are the view's: of images to starboard the last row comes first (patch_view.h). So are
 * columns: bins go outwards in range, from the image's right to its left to port of a nadir_column
 * above 0. */
struct impulse_export;

struct export_facts {
    const char *scene_hash, *image_hash;
    uint64_t image_rows, image_columns;
    struct trace_counts counts;
};

/* Begins a file that is to be found at path once impulse_export_publish has succeeded; until then
 * it has another name. Borrows report and path. On success *export is to be given to
 * impulse_export_release. Errors: STORAGE, MEMORY, UNSUPPORTED (no HDF5 in this build). */
sonject_status impulse_export_begin(struct report *report, const char *path,
                                    struct impulse_export **export);

/* Errors: STORAGE, MEMORY. */
sonject_status impulse_export_lines(struct impulse_export *export,
                                    const struct impulse_lines *lines);
sonject_status impulse_export_publish(struct impulse_export *export, const struct scene *scene,
                                      const struct injection_input *input,
                                      const struct export_facts *facts);

/* Discards what was not published; NULL allowed. */
void impulse_export_release(struct impulse_export **export);

#endif
