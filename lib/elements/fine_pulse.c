#include "elements/fine_pulse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define PI                    3.14159265358979323846
#define SAMPLES_PER_DEVIATION 16.0      /* sharing between two fine samples then errs by 5e-4 */
#define FINE_SAMPLES_MAX      4194304.0 /* 2^22: delays are single precision */

void fine_pulse_clear(struct fine_pulse *pulse)
{
    free(pulse->real_part);
    free(pulse->imaginary_part);
    memset(pulse, 0, sizeof *pulse);
}

/* The image's pulse. */
static void fill_compressed(struct fine_pulse *pulse, uint32_t lead, double metres_per_sample,
                            const struct point_response *response)
{
    for (uint32_t tap = 0; tap < pulse->taps; tap++) {
        const double distance = ((double)lead - (double)tap) * metres_per_sample;
        const struct complex_number value = range_response_complex(response, distance);
        pulse->real_part[tap] = (float)value.real_part;
        pulse->imaginary_part[tap] = (float)value.imaginary_part;
    }
}

/* Upwards through the band in true frequency, which falls in an envelope of exp(-i 2 pi f0 t). The
 * ends count half, as in an integral. */
static void fill_chirp(struct fine_pulse *pulse, const sonject_element_layout *layout,
                       double fine_rate)
{
    const double duration = layout->elements.chirp_duration_s;
    const double rate = layout->bandwidth_hz / duration;
    for (uint32_t tap = 0; tap < pulse->taps; tap++) {
        const double time = (pulse->taps - 1 - tap) / fine_rate;
        const double from_middle = time - 0.5 * duration;
        const double phase = -PI * rate * from_middle * from_middle;
        /* the share of the sample's interval that lies within the chirp */
        const double early = fmin(time * fine_rate + 0.5, 1.0);
        const double late = fmin(fmax((duration - time) * fine_rate + 0.5, 0.0), 1.0);
        const double share = fmin(early, late);
        pulse->real_part[tap] = (float)(share * cos(phase));
        pulse->imaginary_part[tap] = (float)(share * sin(phase));
    }
}

sonject_status fine_pulse_init(struct fine_pulse *pulse, struct report *report,
                               const sonject_element_layout *layout,
                               const struct point_response *response)
{
    const sonject_elements_params *elements = &layout->elements;
    const bool is_chirp = elements->pulse == SONJECT_SERIES_CHIRP;
    const double deviation_s = 2.0 * response->range_deviation_m / layout->sound_speed_mps;
    memset(pulse, 0, sizeof *pulse);
    pulse->fine = (uint32_t)fmax(
        1.0, ceil(SAMPLES_PER_DEVIATION / (deviation_s * elements->sampling_rate_hz) - 1e-9));
    const double fine_rate = elements->sampling_rate_hz * pulse->fine;
    const double metres = 0.5 * layout->sound_speed_mps / fine_rate;
    const double lead =
        ceil(is_chirp ? elements->chirp_duration_s * fine_rate : response->pulse_tail_m / metres);
    const double taps = is_chirp ? lead + 1.0 : 2.0 * lead + 1.0;
    const double samples = ((double)layout->samples - 1.0) * pulse->fine + taps;
    if (samples > FINE_SAMPLES_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "elements: a ping's window of %.3g s at %.4g Hz needs %.3g fine "
                              "samples, more than 2^22: narrow first_time and last_time, or lower "
                              "the sampling rate",
                              (double)layout->samples / elements->sampling_rate_hz,
                              elements->sampling_rate_hz, samples);
    pulse->taps = (uint32_t)taps;
    pulse->first_time_s = elements->first_time_s - lead / fine_rate;
    pulse->real_part = allocate_array(pulse->taps, sizeof(float));
    pulse->imaginary_part = allocate_array(pulse->taps, sizeof(float));
    if (!pulse->real_part || !pulse->imaginary_part) {
        fine_pulse_clear(pulse);
        return report_out_of_memory(report, "the pulse");
    }
    if (is_chirp)
        fill_chirp(pulse, layout, fine_rate);
    else
        fill_compressed(pulse, (uint32_t)lead, metres, response);
    return SONJECT_OK;
}

uint32_t fine_pulse_samples(const struct fine_pulse *pulse, const sonject_element_layout *layout)
{
    return (uint32_t)(layout->samples - 1) * pulse->fine + pulse->taps;
}
