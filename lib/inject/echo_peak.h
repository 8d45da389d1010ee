/* The peak of an object's echo wherever pixels lie and however far apart they are: on a lattice of
 * points that is finer than the point response, and between them. */
#ifndef SONJECT_INJECT_ECHO_PEAK_H
#define SONJECT_INJECT_ECHO_PEAK_H

#include "form/form.h"
#include "trace/tracer.h"

/* Where lines are formed once more. */
struct peak_lattice {
    struct patch_view view;  /* whose pixels are the points */
    struct line_grid grid;   /* of the lines that it was laid on, as that view counts them */
    struct form_lines lines; /* that are being formed */
    float *plane[2];         /* of view.rows x view.columns; owned; NULL: no echo */
};

/* Lays points over a tile: every so many strips and bins of the grid as are a quarter of the
 * resolution, at least one. Errors: MEMORY. */
sonject_status peak_lattice_init(struct peak_lattice *lattice, const struct tracer *tracer,
                                 const struct line_grid *tile, const struct line_grid *grid);
void peak_lattice_clear(struct peak_lattice *lattice);

/* Form lines of a grid of such strips and bins: begin, then form_lines_add to lattice->lines, then
 * finish, which adds them to the planes. Errors: DEVICE, MEMORY. */
sonject_status peak_lattice_begin(struct peak_lattice *lattice, struct tracer *tracer,
                                  enum form_kind kind, const struct line_grid *grid);
sonject_status peak_lattice_finish(struct peak_lattice *lattice);

/* The largest expected cross-section, m^2, of glints (both parts of a field, m) and rough surfaces
 * (energies, m^2) together, and the processor range where it is. 0: there is no echo. */
double peak_of_echo(const struct peak_lattice *glint, const struct peak_lattice *rough,
                    double *range_m);

#endif
