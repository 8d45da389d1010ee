/* Pixels in memory, and their transfer functions. */
#ifndef SONJECT_PIXELS_HPP
#define SONJECT_PIXELS_HPP

#include <cstddef>
#include <cstdint>
#include <vector>

#include <sonject/context.hpp>
#include <sonject/parameters.hpp>
#include <sonject/pixels.h>

namespace sonject
{
namespace detail
{

inline sonject_pixel_kind kind_of(const float *) noexcept
{
    return SONJECT_PIXELS_AMPLITUDE;
}
inline sonject_pixel_kind kind_of(const std::uint8_t *) noexcept
{
    return SONJECT_PIXELS_UINT8;
}
inline sonject_pixel_kind kind_of(const std::uint16_t *) noexcept
{
    return SONJECT_PIXELS_UINT16;
}

} // namespace detail

/* A patch in the caller's memory. */
struct pixels {
    /* Linear amplitudes, or pairs of real and imaginary part. */
    pixels(const float *data, std::uint64_t rows, std::uint64_t columns,
           sonject_pixel_kind kind = SONJECT_PIXELS_AMPLITUDE, std::uint64_t row_stride = 0)
        : value(defaults<sonject_pixels>())
    {
        value.kind = kind;
        value.rows = rows;
        value.columns = columns;
        value.row_stride = row_stride;
        value.data = data;
    }
    /* Stored numbers: float, std::uint8_t or std::uint16_t. transfer stays the caller's, too. */
    template <typename Number>
    pixels(const Number *data, std::uint64_t rows, std::uint64_t columns, const char *transfer,
           std::uint64_t row_stride = 0)
        : value(defaults<sonject_pixels>())
    {
        value.kind = detail::kind_of(data);
        value.rows = rows;
        value.columns = columns;
        value.row_stride = row_stride;
        value.data = data;
        value.transfer = transfer;
    }
    sonject_pixels value;
};

/* Converts the patch to other numbers (float, std::uint8_t or std::uint16_t) with a transfer
 * function, or to linear ones; see sonject_pixels_convert. */
template <typename Number>
std::vector<Number> convert_pixels(const context &context, const pixels &patch,
                                   const char *transfer = nullptr)
{
    std::vector<Number> made(static_cast<std::size_t>(patch.value.rows * patch.value.columns));
    context.check(sonject_pixels_convert(context.get(), &patch.value, detail::kind_of(made.data()),
                                         transfer, made.data(), made.size() * sizeof(Number)));
    return made;
}

} // namespace sonject

#endif
