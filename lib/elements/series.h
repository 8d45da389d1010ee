/* Time series of the hydrophones from impulses (kernels/MATH.md, "Element level"), and the pulse of
 * a series, on samples so fine that echoes may be shared between two of them. */
#ifndef SONJECT_ELEMENTS_SERIES_H
#define SONJECT_ELEMENTS_SERIES_H

#include <sonject/context.h>

#include "base/report.h"
#include "elements/impulse_list.h"
#include "kernels/element_series_records.h"
#include "scene/element_plan.h"

struct fine_pulse {
    uint32_t fine; /* samples for each of the series */
    uint32_t taps;
    double first_time_s;               /* of fine sample 0 */
    float *real_part, *imaginary_part; /* owned, taps each: sample n of the series is the sum over
                                          taps of fine sample n * fine + tap times tap */
};

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
