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
#ifndef SONJECT_INJECT_IMPULSE_EXPORT_H
#define SONJECT_INJECT_IMPULSE_EXPORT_H

#include "inject/impulse_file.h"
#include "inject/injection.h"

struct impulse_export;

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
