/* Injections into pixels in memory. */
#ifndef SONJECT_INJECTION_HPP
#define SONJECT_INJECTION_HPP

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <sonject/error.hpp>
#include <sonject/parameters.hpp>
#include <sonject/pixels.hpp>
#include <sonject/progress.hpp>
#include <sonject/result.h>
#include <sonject/scene.hpp>
#include <sonject/span.hpp>

namespace sonject
{

/* The result of an injection. */
class result
{
  public:
    result(sonject_result *handle, sonject_context *context, std::uint32_t objects) noexcept
        : handle_(handle), context_(context), objects_(objects)
    {
    }
    result(result &&other) noexcept
        : handle_(other.handle_), context_(other.context_), objects_(other.objects_)
    {
        other.handle_ = nullptr;
    }
    result &operator=(result &&other) noexcept
    {
        std::swap(handle_, other.handle_);
        std::swap(context_, other.context_);
        std::swap(objects_, other.objects_);
        return *this;
    }
    result(const result &) = delete;
    result &operator=(const result &) = delete;
    ~result()
    {
        sonject_result_release(&handle_);
    }

    sonject_result *get() const noexcept
    {
        return handle_;
    }
    std::uint64_t rows() const
    {
        return size().rows;
    }
    std::uint64_t columns() const
    {
        return size().columns;
    }
    bool is_complex() const
    {
        return size().kind == SONJECT_PIXELS_COMPLEX;
    }

    /* Copies a layer into memory of exactly its size: the patch's numbers for IMAGE (pairs if
     * is_complex), float for FIELD (pairs), ENERGY and VISIBILITY, std::uint8_t for the masks. */
    template <typename Element> void layer(sonject_layer layer, span<Element> buffer) const
    {
        check(sonject_result_layer(handle_, layer, buffer.data(), buffer.size() * sizeof(Element)));
    }
    std::vector<float> energy() const
    {
        return copy<float>(SONJECT_LAYER_ENERGY, 1);
    }
    /* Copies the image. Number: float, std::uint8_t or std::uint16_t, as in the patch. */
    template <typename Number = float> std::vector<Number> image() const
    {
        return copy<Number>(SONJECT_LAYER_IMAGE, is_complex() ? 2 : 1);
    }
    /* Copies a mask: HIGHLIGHT, SHADOW, LABELS or INFLUENCE. */
    std::vector<std::uint8_t> mask(sonject_layer layer) const
    {
        return copy<std::uint8_t>(layer, 1);
    }
    /* Copies the expected energy of the paths that meet `order` surfaces, if the scene asked for
     * it. */
    std::vector<float> order_energy(std::uint32_t order) const
    {
        const measure extent = size();
        std::vector<float> buffer(static_cast<std::size_t>(extent.rows * extent.columns));
        check(sonject_result_order_energy(handle_, order, buffer.data(),
                                          buffer.size() * sizeof(float)));
        return buffer;
    }

    std::uint32_t object_count() const noexcept
    {
        return objects_;
    }
    sonject_object_truth object(std::uint32_t index) const
    {
        sonject_object_truth truth = defaults<sonject_object_truth>();
        check(sonject_result_object(handle_, index, &truth));
        return truth;
    }
    sonject_statistics statistics() const
    {
        sonject_statistics numbers = defaults<sonject_statistics>();
        check(sonject_result_statistics(handle_, &numbers));
        return numbers;
    }

  private:
    struct measure {
        std::uint64_t rows, columns;
        std::uint32_t kind;
    };
    measure size() const
    {
        measure extent = {0, 0, 0};
        check(sonject_result_size(handle_, &extent.rows, &extent.columns, &extent.kind));
        return extent;
    }
    template <typename Element>
    std::vector<Element> copy(sonject_layer layer, std::size_t parts) const
    {
        const measure extent = size();
        std::vector<Element> buffer(static_cast<std::size_t>(extent.rows * extent.columns) * parts);
        this->layer(layer, span<Element>(buffer));
        return buffer;
    }
    void check(sonject_status status) const
    {
        detail::check(context_, status);
    }
    sonject_result *handle_;
    sonject_context *context_;
    std::uint32_t objects_;
};

namespace detail
{

/* Returns the result that call(function, user, &handle) makes. */
template <typename Call>
result make_result(sonject_context *context, std::uint32_t objects, const progress &callback,
                   const Call &call)
{
    sonject_result *handle = nullptr;
    try {
        tell_progress(context, callback, [&](sonject_progress_function tell, void *user) {
            return call(tell, user, &handle);
        });
    } catch (...) { /* thrown by the callback, perhaps after the result was made */
        sonject_result_release(&handle);
        throw;
    }
    return result(handle, context, objects);
}

inline result inject(const scene &scene, const sonject_pixels *pixels, const progress &callback)
{
    sonject_context *context = scene.context_handle();
    return make_result(context, scene.object_count(), callback,
                       [&](sonject_progress_function tell, void *user, sonject_result **handle) {
                           return sonject_inject(context, scene.get(), pixels, tell, user, handle);
                       });
}

} // namespace detail

/* Puts the scene's objects into a patch; see sonject_inject. */
inline result inject(const scene &scene, const pixels &patch, const progress &callback = progress())
{
    return detail::inject(scene, &patch.value, callback);
}

/* Puts the scene's objects into the swath that the scene itself makes (uniform or synthetic). */
inline result inject(const scene &scene, const progress &callback = progress())
{
    return detail::inject(scene, nullptr, callback);
}

} // namespace sonject

#endif
