/* Files of impulses, HDF5: what tracing leaves, so that images can be formed later, with another
 * pulse or cross-range response too.
 *
 *   /                  attributes: format "sonject impulses", format_version 1, sonject (version)
 *   /scene             attributes: hash (of all that tracing depends on), path (as it was given),
 *                      folder (that relative names are meant from), seed; datasets: text (the
 *                      scene's YAML) and overrides (its --set, one a string); neither where the
 *                      scene came from no file
 *   /image             attributes: path, rows, columns, xxhash (XXH3, of size and patch pixels)
 *   /sonar             attributes: what the grids were laid for: bandwidth_hz,
 *                      along_track_resolution_m, response_window, taylor_sidelobe_db, taylor_terms
 *   /patch             attributes: first_row, first_column, rows, columns (of the swath),
 *                      row_spacing_m, column_spacing_m, first_slant_range_m
 *   /counts            attributes: pings, rays, ray_queries, impulses
 *   /seabed            energy; in_view where the patch is resynthesised   (m^2)
 *   /objects/NUMBER    energy (m^2), footprint (rays), lost (m^2); objects count from 0
 *   /glints/PART       real, imaginary (m); parts count from 0 over all objects; only smooth ones
 *   /beam              energy (m^2) that each ping hears of an even seabed; only of a real aperture
 *   /hidden/NUMBER     lost (m^2): of that, what an object hides
 *   /level             energy (m^2); only with relief
 *   /chains/ORDER      energy (m^2) of paths of that many interactions, or of all from there on
 *                      where orders are not kept apart; only with several interactions
 *
 * Each set of lines has the attributes of its grid (scene/line_grid.h): strips_per_row,
 * bins_per_pixel, first_strip, strips, first_bin, bins; its datasets are strips x bins of 32-bit
 * floats in chunks of whole strips of about 1 MB, shuffled, deflated (level 1), with Fletcher-32
 * checksums. Rows are the view's: of images to starboard the last row comes first (patch_view.h).
 * Headers are in the format of HDF5 1.10, with checksums; a hash of the whole file stands before
 * them (impulse_seal.h), so that none that was cut short or changed by accident is read. */
#ifndef SONJECT_INJECT_IMPULSE_FILE_H
#define SONJECT_INJECT_IMPULSE_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "base/hash.h"
#include "base/report.h"
#include "inject/impulses.h"
#include "trace/tracer.h"

#define IMPULSE_FORMAT         "sonject impulses"
#define IMPULSE_FORMAT_VERSION 1

/* What a file says of itself. Texts are owned. */
struct impulse_head {
    char version[32]; /* of sonject */
    char scene_hash[HASH_TEXT_CAPACITY];
    char *scene_text; /* NULL: the scene came from no file */
    char *scene_path, *scene_folder;
    char **overrides;
    size_t override_count;
    uint64_t seed;
    char *image_path; /* "" if it is made */
    char image_hash[HASH_TEXT_CAPACITY];
    uint64_t image_rows, image_columns;
    sonject_sonar_params sonar; /* of which only what /sonar says */
    uint64_t first_row, first_column, rows, columns;
    double row_spacing_m, column_spacing_m, first_slant_range_m;
    struct trace_counts counts;
};

void impulse_head_clear(struct impulse_head *head);

/* Gives a sonar what the trace was laid for: the members that image formation alone depends on. */
void impulse_head_take_sonar(const struct impulse_head *head, sonject_sonar_params *sonar);

struct impulse_writer;

/* Begins a file that is to be found at path once impulse_writer_publish has succeeded; until then
 * it has another name. Borrows report and path. On success *writer is to be given to
 * impulse_writer_release. Errors: STORAGE, MEMORY, UNSUPPORTED (no HDF5 in this build). */
sonject_status impulse_writer_begin(struct report *report, const char *path,
                                    struct impulse_writer **writer);

/* Writes what it takes. Errors: STORAGE, MEMORY. */
struct impulse_sink impulse_writer_sink(struct impulse_writer *writer);
sonject_status impulse_writer_publish(struct impulse_writer *writer,
                                      const struct impulse_head *head);

/* Discards what was not published; NULL allowed. */
void impulse_writer_release(struct impulse_writer **writer);

struct impulse_file;

/* Opens a file and reads its head; lines are read when they are asked for. Borrows report and path.
 * Errors: STORAGE (cannot be read), INPUT (no such file, or not one of impulses, or damaged),
 * MEMORY, UNSUPPORTED. */
sonject_status impulse_file_open(struct report *report, const char *path,
                                 struct impulse_file **file);
const struct impulse_head *impulse_file_head(const struct impulse_file *file);
void impulse_file_close(struct impulse_file **file);

/* Hands out the file's impulses, and its counts to the tracer. The tracer's scene must be the one
 * that was traced, but for the sonar's pulse and cross-range response. Errors: INPUT (damaged, a
 * grid that is not the scene's, a response that cannot be formed: reimaging.h), MEMORY, CANCELLED,
 * and the sink's own. */
struct impulse_source impulse_file_source(struct impulse_file *file);

/* Names of a set's datasets, in the order of its planes. */
const char *const *impulse_plane_names(enum impulse_kind kind);

/* The set's group: "/objects/12". */
#define IMPULSE_GROUP_CAPACITY 32
void impulse_group_name(enum impulse_kind kind, uint32_t number, char name[IMPULSE_GROUP_CAPACITY]);

#endif
