/* Time series of the hydrophones (kernels/MATH.md, "Element level"). An impulse is a cell of a
 * traced line that is not empty. A list keeps impulses until all are there. A source level and the
 * water's absorption turn ratios of pressures into pressures. */
#ifndef SONJECT_ELEMENTS_ELEMENTS_H
#define SONJECT_ELEMENTS_ELEMENTS_H

#include <sonject/context.h>

#include "base/report.h"
#include "device/device.h"
#include "scene/element_plan.h"
#include "scene/patch_view.h"

/* The impulses of some strips of a grid. All members are owned. */
struct impulse_piece {
    struct line_grid grid; /* has only the piece's strips */
    int32_t *starts;       /* first impulse of each strip, strips.count + 1 numbers */
    int32_t *bins;         /* bin of each impulse on the grid's numbering, rising within a strip */
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

/* Adds the impulses of some strips of a grid. The two planes of strips.count x grid->bins.count
 * hold complex amplitudes, m. Errors: MEMORY, INPUT (more than 2^31 - 1 impulses at a time). */
sonject_status impulse_list_add(struct impulse_list *list, const struct line_grid *grid,
                                struct span strips, const float *real_part,
                                const float *imaginary_part);

/* Adds impulses of amplitudes sqrt(energy) times the complex normal deviates of image formation.
 * Errors: those of impulse_list_add, DEVICE. */
sonject_status impulse_list_add_speckle(struct impulse_list *list, const struct line_grid *grid,
                                        struct span strips, const float *energy, uint64_t seed,
                                        uint32_t stream);

/* Scales impulses to pressures in Pa m for a source of this level. The pressure is sqrt(2) times
 * the rms one at 1 m, 10^(level / 20) uPa. Absorption is subtracted for the way there and back at
 * the impulse's own range. */
void impulse_list_set_source_level(struct impulse_list *list, const struct patch_view *view,
                                   double source_level_db, double absorption_db_per_m);

struct series_request {
    const sonject_element_layout *layout;
    const struct patch_view *view;
    const struct point_response *response;
    const struct impulse_list *impulses;
    sonject_progress_function progress; /* may be NULL; told from first_fraction to 1 */
    void *user;
    double first_fraction;
};

/* Computes series: pings x hydrophones x samples, pairs of real and imaginary part in base band,
 * single reals in pass band. Errors: INPUT (windows of more than 2^22 fine samples), DEVICE,
 * MEMORY, CANCELLED. */
sonject_status series_compute(const struct series_request *request, struct report *report,
                              struct device *device, float *series);

#endif
