/* Time series of the hydrophones (kernels/MATH.md, "Element level"): impulses that are heard, which
 * are traced lines without their empty cells, kept until all are there; and what leads from ratios
 * of pressures to pressures, a source level and what the water absorbs. */
#ifndef SONJECT_ELEMENTS_ELEMENTS_H
#define SONJECT_ELEMENTS_ELEMENTS_H

#include <sonject/context.h>

#include "base/report.h"
#include "device/device.h"
#include "scene/element_plan.h"
#include "scene/patch_view.h"

/* Some strips of a grid. All owned. */
struct impulse_piece {
    struct line_grid grid;             /* strips: only these */
    int32_t *starts;                   /* of each strip's impulses, strips.count + 1 */
    int32_t *bins;                     /* on the grid's numbering, rising within a strip */
    float *real_part, *imaginary_part; /* m */
    size_t count;
    int32_t last_bin;
};

struct impulse_list {
    struct report *report;
    struct device *device;
    struct impulse_piece *pieces; /* owned */
    size_t count;
};

void impulse_list_init(struct impulse_list *list, struct report *report, struct device *device);
void impulse_list_clear(struct impulse_list *list);

/* Adds strips of a grid: complex amplitudes in m, strips.count x grid->bins.count, in two planes.
 * Errors: MEMORY, INPUT (more than 2^31 - 1 impulses at a time). */
sonject_status impulse_list_add(struct impulse_list *list, const struct line_grid *grid,
                                struct span strips, const float *real_part,
                                const float *imaginary_part);

/* The same with amplitudes sqrt(energy) times the complex normal deviates of image formation.
 * Errors: also DEVICE. */
sonject_status impulse_list_add_speckle(struct impulse_list *list, const struct line_grid *grid,
                                        struct span strips, const float *energy, uint64_t seed,
                                        uint32_t stream);

/* Scales impulses to the pressure, in Pa m, that a source of this level makes of them: sqrt(2)
 * times its rms pressure at 1 m, 10^(level / 20) uPa, less absorption on the way there and back at
 * the impulse's own range. */
void impulse_list_set_source_level(struct impulse_list *list, const struct patch_view *view,
                                   double source_level_db, double absorption_db_per_m);

struct series_request {
    const sonject_element_layout *layout;
    const struct patch_view *view;
    const struct point_response *response;
    const struct impulse_list *impulses;
    sonject_progress_function progress; /* may be NULL; is told from first_fraction to 1 */
    void *user;
    double first_fraction;
};

/* Fills series: pings x hydrophones x samples, pairs of real and imaginary part in base band.
 * Errors: INPUT (windows of more than 2^22 fine samples), DEVICE, MEMORY, CANCELLED. */
sonject_status series_compute(const struct series_request *request, struct report *report,
                              struct device *device, float *series);

#endif
