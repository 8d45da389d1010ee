/* The pulse of a series, on samples so fine that echoes may be shared between two of them. */
#ifndef SONJECT_ELEMENTS_FINE_PULSE_H
#define SONJECT_ELEMENTS_FINE_PULSE_H

#include "base/report.h"
#include "scene/element_plan.h"

struct fine_pulse {
    uint32_t fine; /* samples for each of the series */
    uint32_t taps;
    double first_time_s;               /* of fine sample 0 */
    float *real_part, *imaginary_part; /* owned, taps each: sample n of the series is the sum over
                                          taps of fine sample n * fine + tap times tap */
};

/* On success to be given to fine_pulse_clear. Errors: MEMORY, INPUT (too many fine samples). */
sonject_status fine_pulse_init(struct fine_pulse *pulse, struct report *report,
                               const sonject_element_layout *layout,
                               const struct point_response *response);
void fine_pulse_clear(struct fine_pulse *pulse);

/* Fine samples that the series is made of. */
uint32_t fine_pulse_samples(const struct fine_pulse *pulse, const sonject_element_layout *layout);

#endif
