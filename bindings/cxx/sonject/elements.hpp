/* Time series of an array's hydrophones. */
#ifndef SONJECT_ELEMENTS_HPP
#define SONJECT_ELEMENTS_HPP

#include <cstddef>
#include <vector>

#include <sonject/elements.h>
#include <sonject/injection.hpp>
#include <sonject/progress.hpp>
#include <sonject/scene.hpp>

namespace sonject
{

/* Computes the time series of the scene's array: pings x hydrophones x samples of
 * scene::describe_elements, in base band pairs of real and imaginary part. */
inline std::vector<float> element_series(const scene &scene, const pixels &patch,
                                         const progress &callback = progress())
{
    const sonject_element_layout layout =
        scene.describe_elements(patch.value.rows, patch.value.columns);
    const sonject_elements_params &elements = layout.elements;
    const std::size_t parts = elements.form == SONJECT_SERIES_BASEBAND ? 2 : 1;
    std::vector<float> series(static_cast<std::size_t>(layout.samples) * elements.hydrophones *
                              elements.pings * parts);
    sonject_context *context = scene.context_handle();
    detail::tell_progress(context, callback, [&](sonject_progress_function tell, void *user) {
        return sonject_element_series(context, scene.get(), &patch.value, tell, user, series.data(),
                                      series.size() * sizeof(float));
    });
    return series;
}

} // namespace sonject

#endif
