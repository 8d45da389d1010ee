#include "scene/element_plan.h"

#include <math.h>

#define SAMPLES_MAX 16777216.0
#define VALUES_MAX  70368744177664.0 /* 2^46 */

/* Returns half of the track from which a point at the range is seen at the aspects of the image. */
static double half_aperture(const sonject_element_layout *layout, double range_m)
{
    const double sine = layout->sound_speed_mps / layout->centre_frequency_hz /
                        (4.0 * layout->along_track_resolution_m);
    return range_m * sine / sqrt(1.0 - sine * sine);
}

static double array_length(const sonject_elements_params *elements)
{
    return (elements->hydrophones - 1) * elements->hydrophone_spacing_m;
}

/* Returns the mean place of the phase centres, midway between transmitter and hydrophones. */
static double mean_phase_centre(const sonject_elements_params *elements)
{
    return 0.5 * (elements->transmitter_offset_m + elements->first_hydrophone_m +
                  0.5 * array_length(elements));
}

static void plan_array(sonject_element_layout *layout)
{
    sonject_elements_params *elements = &layout->elements;
    const double usual = 2.0 * layout->along_track_resolution_m;
    if (isnan(elements->transmitter_length_m))
        elements->transmitter_length_m = usual;
    if (isnan(elements->hydrophone_length_m))
        elements->hydrophone_length_m = usual;
    if (elements->hydrophone_spacing_m == 0.0)
        elements->hydrophone_spacing_m =
            elements->hydrophone_length_m > 0.0 ? elements->hydrophone_length_m : usual;
    if (isnan(elements->first_hydrophone_m))
        elements->first_hydrophone_m = -0.5 * array_length(elements);
    if (elements->ping_spacing_m == 0.0)
        elements->ping_spacing_m = 0.5 * elements->hydrophones * elements->hydrophone_spacing_m;
}

static sonject_status plan_pings(sonject_element_layout *layout, struct report *report,
                                 const struct patch_view *view)
{
    sonject_elements_params *elements = &layout->elements;
    const double last_range = view_processor_range(view, (double)view->columns - 1.0);
    const double half = half_aperture(layout, last_range);
    const double patch = (double)(view->rows - 1) * view->row_spacing_m;
    const double first_x = view->is_mirrored ? -(view->first_x_m + patch) : view->first_x_m;
    if (elements->pings == 0) {
        const double pings = ceil((patch + 2.0 * half) / elements->ping_spacing_m) + 1.0;
        if (pings > 16777216.0)
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "elements: %.0f pings, %g m apart, would be needed; at most 2^24 "
                                  "are possible: give pings.spacing or pings.count",
                                  pings, elements->ping_spacing_m);
        elements->pings = (uint32_t)pings;
    }
    if (isnan(elements->first_ping_m))
        elements->first_ping_m = first_x + 0.5 * patch -
                                 0.5 * (elements->pings - 1) * elements->ping_spacing_m -
                                 mean_phase_centre(elements);
    return SONJECT_OK;
}

double element_least_rate(const sonject_elements_params *elements, double frequency_hz,
                          double bandwidth_hz)
{
    return elements->form == SONJECT_SERIES_PASSBAND ? 2.0 * frequency_hz + bandwidth_hz
                                                     : bandwidth_hz;
}

static void plan_rate(sonject_element_layout *layout)
{
    sonject_elements_params *elements = &layout->elements;
    const double carrier =
        elements->form == SONJECT_SERIES_PASSBAND ? 2.0 * layout->centre_frequency_hz : 0.0;
    if (elements->sampling_rate_hz == 0.0)
        elements->sampling_rate_hz = carrier + 2.0 * layout->bandwidth_hz;
}

/* Finds the times of the first and last sample that the patch's aperture needs, with the pulse. */
static sonject_status plan_times(sonject_element_layout *layout, struct report *report,
                                 const struct patch_view *view,
                                 const struct point_response *response)
{
    sonject_elements_params *elements = &layout->elements;
    const double c = layout->sound_speed_mps;
    const double reach = response->pulse_tail_m;
    const double first_range = view_processor_range(view, 0.0) - reach;
    const double last_range = view_processor_range(view, (double)view->columns - 1.0) + reach;
    const double aside = half_aperture(layout, last_range) + 0.5 * array_length(elements) +
                         fabs(elements->transmitter_offset_m);
    const bool is_chirp = elements->pulse == SONJECT_SERIES_CHIRP;
    if (isnan(elements->first_time_s))
        elements->first_time_s = fmax(0.0, 2.0 * (first_range - (is_chirp ? 0.0 : reach)) / c);
    if (isnan(elements->last_time_s))
        elements->last_time_s = 2.0 * hypot(last_range, aside) / c +
                                (is_chirp ? elements->chirp_duration_s : 2.0 * reach / c);
    const double samples =
        floor((elements->last_time_s - elements->first_time_s) * elements->sampling_rate_hz +
              1e-6) +
        1.0;
    if (!(samples >= 1.0))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "elements: the window from %g s to %g s is empty: correct first_time "
                              "or last_time",
                              elements->first_time_s, elements->last_time_s);
    if (samples > SAMPLES_MAX ||
        samples * elements->hydrophones * (double)elements->pings > VALUES_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "elements: %.0f samples of %u hydrophones and %u pings are too many "
                              "(2^24 samples, 2^46 in all): narrow the times or lower "
                              "sampling_rate",
                              samples, (unsigned)elements->hydrophones, (unsigned)elements->pings);
    layout->samples = (uint64_t)samples;
    return SONJECT_OK;
}

sonject_status element_plan(sonject_element_layout *layout, struct report *report,
                            const struct scene *scene, const struct patch_view *view,
                            const struct point_response *response)
{
    layout->elements = scene->elements;
    layout->elements.struct_size = sizeof layout->elements;
    layout->sound_speed_mps = scene_reference_speed(scene);
    layout->centre_frequency_hz = scene->sonar.centre_frequency_hz;
    layout->bandwidth_hz = scene->sonar.bandwidth_hz;
    layout->along_track_resolution_m = response->resolution_m;
    const double wavelength = layout->sound_speed_mps / layout->centre_frequency_hz;
    if (wavelength >= 4.0 * response->resolution_m)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "elements: no aperture on a straight track resolves %g m at a "
                              "wavelength of %g m",
                              response->resolution_m, wavelength);
    plan_array(layout);
    CHECK(plan_pings(layout, report, view));
    plan_rate(layout);
    return plan_times(layout, report, view, response);
}

size_t element_plan_samples(const sonject_element_layout *layout)
{
    return (size_t)layout->samples * layout->elements.hydrophones * layout->elements.pings;
}

double element_transmitter_m(const sonject_elements_params *elements, uint32_t ping)
{
    return elements->first_ping_m + ping * elements->ping_spacing_m +
           elements->transmitter_offset_m;
}

double element_hydrophone_m(const sonject_elements_params *elements, uint32_t ping,
                            uint32_t hydrophone)
{
    return elements->first_ping_m + ping * elements->ping_spacing_m + elements->first_hydrophone_m +
           hydrophone * elements->hydrophone_spacing_m;
}
