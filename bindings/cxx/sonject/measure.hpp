/* Measures of images and contacts. */
#ifndef SONJECT_MEASURE_HPP
#define SONJECT_MEASURE_HPP

#include <cstdint>
#include <string>

#include <sonject/calibrate.h>
#include <sonject/context.hpp>
#include <sonject/error.hpp>
#include <sonject/measure.h>
#include <sonject/parameters.hpp>
#include <sonject/pixels.hpp>
#include <sonject/span.hpp>
#include <sonject/text.hpp>

namespace sonject
{

/* Measures the seabed of an image file; see sonject_measure. */
inline sonject_measurement measure(const context &context, const sonject_measure_params &params)
{
    sonject_measurement measurement = defaults<sonject_measurement>();
    context.check(sonject_measure(context.get(), &params, &measurement));
    return measurement;
}

/* Measures the seabed of pixels in memory. labels: rows x columns bytes, or none. */
inline sonject_measurement measure(const context &context, const pixels &image,
                                   span<const std::uint8_t> labels = span<const std::uint8_t>())
{
    sonject_measure_params params = defaults<sonject_measure_params>();
    if (labels.size() && labels.size() != image.value.rows * image.value.columns)
        throw error(SONJECT_ERROR_ARGUMENT, "a mask needs rows x columns bytes");
    params.pixels = &image.value;
    params.labels_mask = labels.size() ? labels.data() : nullptr;
    return measure(context, params);
}

/* Estimates the properties of a swath for scenes; see sonject_calibrate. */
inline std::string calibrate(const context &context, const sonject_calibrate_params &params)
{
    detail::text text;
    context.check(sonject_calibrate(context.get(), &params, text.out()));
    return text.copy();
}

/* Measures the contacts of an image, as JSON; see sonject_measure_contacts. */
inline std::string measure_contacts(const context &context, const sonject_measure_params &params)
{
    detail::text text;
    context.check(sonject_measure_contacts(context.get(), &params, text.out()));
    return text.copy();
}

/* Measures lengths and levels of a contact; see sonject_measure_contact. box: nullptr for the
 * brightest. */
inline sonject_contact_measures measure_contact(const context &context, const pixels &image,
                                                const sonject_box *box = nullptr,
                                                double row_spacing_m = 0.0,
                                                double column_spacing_m = 0.0)
{
    sonject_contact_measures measures = defaults<sonject_contact_measures>();
    context.check(sonject_measure_contact(context.get(), &image.value, box, row_spacing_m,
                                          column_spacing_m, &measures));
    return measures;
}

} // namespace sonject

#endif
