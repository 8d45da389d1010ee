#include "elements/series_records.h"

#include <math.h>
#include <string.h>

#define STRIPS_AWAY_MAX  1e9
#define ANY_SLOPE_SQUARE 1e16

typedef char impulse_grid_record_is_packed[sizeof(struct impulse_grid_record) == 14 * 4 ? 1 : -1];
typedef char element_pair_record_is_packed[sizeof(struct element_pair_record) == 4 * 4 ? 1 : -1];

/* Square of the tangent of the aspect limit; more than any where there is none. */
static double largest_slope_squared(const sonject_elements_params *elements)
{
    const double slope = tan(elements->aspect_limit_rad);
    return elements->aspect_limit_rad > 0.0 ? fmin(slope * slope, ANY_SLOPE_SQUARE)
                                            : ANY_SLOPE_SQUARE;
}

struct impulse_grid_record impulse_grid_record_of(const sonject_element_layout *layout,
                                                  const struct patch_view *view,
                                                  const struct impulse_piece *piece,
                                                  const struct fine_pulse *pulse, int32_t segments)
{
    const sonject_elements_params *elements = &layout->elements;
    const double c = layout->sound_speed_mps;
    const double wavelength = c / layout->centre_frequency_hz;
    const double bin_width = view->column_spacing_m / piece->grid.bins_per_pixel;
    const double reference = view_apparent_range(view, 0.0);
    const double fine_rate = elements->sampling_rate_hz * pulse->fine;
    struct impulse_grid_record record;
    memset(&record, 0, sizeof record);
    record.strip_width = (float)(view->row_spacing_m / piece->grid.strips_per_row);
    record.bin_width = (float)bin_width;
    record.reference_range = (float)reference;
    record.first_strip = piece->grid.strips.first;
    record.strips = piece->grid.strips.count;
    record.largest_range = (float)(reference + piece->last_bin * bin_width);
    record.cycles_per_metre = (float)(1.0 / wavelength);
    record.samples_per_metre = (float)(fine_rate / c);
    record.first_sample = (float)((2.0 * reference / c - pulse->first_time_s) * fine_rate);
    record.transmitter_cycles = (float)(0.5 * elements->transmitter_length_m / wavelength);
    record.hydrophone_cycles = (float)(0.5 * elements->hydrophone_length_m / wavelength);
    record.largest_slope_squared = (float)largest_slope_squared(elements);
    record.samples = (int32_t)fine_pulse_samples(pulse, layout);
    record.segments = segments;
    return record;
}

/* Position on the numbering of a piece's strips: whole strips, and the rest. */
static void find_strip(const struct patch_view *view, const struct impulse_piece *piece,
                       double along_track_m, int32_t *strip, float *fraction)
{
    const double per_row = piece->grid.strips_per_row;
    const double x = view->is_mirrored ? -along_track_m : along_track_m;
    const double position = (view_row_of_x(view, x) + 0.5) * per_row - 0.5;
    const double limited = fmax(-STRIPS_AWAY_MAX, fmin(position, STRIPS_AWAY_MAX));
    *strip = (int32_t)floor(limited);
    *fraction = (float)(limited - floor(limited));
}

void element_pair_records_fill(struct element_pair_record *records,
                               const sonject_elements_params *elements,
                               const struct patch_view *view, const struct impulse_piece *piece,
                               size_t first, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const uint32_t ping = (uint32_t)((first + i) / elements->hydrophones);
        const uint32_t hydrophone = (uint32_t)((first + i) % elements->hydrophones);
        struct element_pair_record *record = &records[i];
        find_strip(view, piece, element_transmitter_m(elements, ping), &record->transmitter_strip,
                   &record->transmitter_fraction);
        find_strip(view, piece, element_hydrophone_m(elements, ping, hydrophone),
                   &record->hydrophone_strip, &record->hydrophone_fraction);
    }
}
