/* What tracing leaves for image formation: lines of bins on fine grids, from rays or from a file of
 * sums. */
#ifndef SONJECT_INJECT_IMPULSES_H
#define SONJECT_INJECT_IMPULSES_H

#include <stdint.h>

#include <sonject/status.h>

#include "scene/patch_view.h"
#include "trace/sums_file.h"
#include "trace/tracer.h"

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

/* By rays: traces everything that the request asks for, and hands it on as it comes. Errors: INPUT,
 * DEVICE, MEMORY, CANCELLED, and the sink's own. */
sonject_status trace_impulses(struct tracer *tracer, const struct echo_request *request,
                              const struct impulse_sink *sink);
struct impulse_source traced_impulses(void);

/* Impulses in a file of sums (trace/sums_file.h), so that images can be formed later, with another
 * pulse or cross-range response too. Its head has shard 1 of 1, the hash of what tracing depends on
 * and the scene's text, and no digest of launches. Its records, 64-bit words each:
 *
 *   lines  LINES_HEAD_WORDS numbers: kind, number, strips_per_row, bins_per_pixel, the grid's first
 *          strip and strips, its first bin and bins, first strip and strips of these lines, planes;
 *          then the planes' 32-bit floats, one plane after the other, and one 0 where they are odd.
 *          In the order in which tracing hands them out.
 *   facts  the last record: struct impulse_facts, then the image's path, terminated */

/* What was traced, and what the grids were laid for. */
struct impulse_facts {
    char image_hash[SUMS_DIGEST_CAPACITY]; /* of size and patch pixels */
    uint64_t image_rows, image_columns;
    double bandwidth_hz, along_track_resolution_m, taylor_sidelobe_db;
    uint64_t response_window, taylor_terms;
    struct trace_counts counts;
};

/* Between the members that image formation alone depends on and a sonar. */
void impulse_facts_note_sonar(struct impulse_facts *facts, const sonject_sonar_params *sonar);
void impulse_facts_take_sonar(const struct impulse_facts *facts, sonject_sonar_params *sonar);

#define LINES_HEAD_WORDS 11

/* A sink whose taker is a struct sums_writer, to which it appends the lines. Errors: STORAGE,
 * MEMORY. */
sonject_status impulse_lines_write(void *writer, const struct impulse_lines *lines);

/* Appends the last record and gives the file its name. head: whose the impulses are; source may be
 * NULL; image_path: "" if the image is made. Errors: STORAGE, MEMORY. */
sonject_status impulse_file_publish(struct sums_writer *writer, const struct sums_head *head,
                                    const struct scene_source *source,
                                    const struct impulse_facts *facts, const char *image_path);

struct impulse_file {
    struct report *report;
    struct sums_file sums;
    struct impulse_facts facts;
    void *last;             /* record; owned */
    const char *image_path; /* in it */
};

/* Reads a file from end to end; lines are read again when they are asked for. Borrows report. On
 * success to be given to impulse_file_close; on failure nothing is held. Errors: INPUT (no such
 * file, or not one that sonject_trace wrote, or damaged), STORAGE, MEMORY. */
sonject_status impulse_file_open(struct report *report, const char *path,
                                 struct impulse_file *file);
void impulse_file_close(struct impulse_file *file);

/* Hands out the file's impulses, and its counts to the tracer. The tracer's scene must be the one
 * that was traced, but for the sonar's pulse and cross-range response. Errors: INPUT (damaged; a
 * grid that is not the scene's, or too coarse or too narrow for the response), MEMORY, CANCELLED,
 * and the sink's own. */
struct impulse_source impulse_file_source(struct impulse_file *file);

/* Impulses as arrays for other programs, in HDF5; nothing is read back from it.
 *
 *   /                  attributes: sonject (version), scene (hash of all that tracing depends on),
 *                      seed, the image's path, hash, rows and columns, what the grids were laid
 *                      for, the patch in the swath, and what was counted; units in their names
 *   /seabed            energy; in_view where the patch is resynthesised   (m^2)
 *   /objects/NUMBER    energy (m^2), footprint (rays), lost (m^2); objects count from 0
 *   /glints/PART       real, imaginary (m); parts count from 0 over all objects; only smooth ones
 *   /beam              energy (m^2) that each ping hears of an even seabed; only of a real aperture
 *   /hidden/NUMBER     lost (m^2): of that, what an object hides
 *   /level             energy (m^2); only with relief
 *   /chains/ORDER      energy (m^2) of paths of that many interactions, or of all from there on
 *                      where orders are not kept apart; only with several interactions
 *
 * Each set of lines has the attributes of its grid (scene/patch_view.h): strips_per_row,
 * bins_per_pixel, first_strip, strips, first_bin, bins; its datasets are strips x bins of 32-bit
 * floats with an attribute units, in chunks of whole strips of about 1 MB, shuffled and deflated.
 * Rows are the view's: of images to starboard the last row comes first (patch_view.h). */
struct impulse_export;
struct injection_input;

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
                                      const struct impulse_facts *facts, const char *scene_hash,
                                      const char *image_path);

/* Discards what was not published; NULL allowed. */
void impulse_export_release(struct impulse_export **export);

#endif
