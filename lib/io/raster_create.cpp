/* New image files. */
#include "io/raster_image.h"

#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "io/image_kind.h"
#include "io/png_chunks.h"
#include "io/raster_failure.hpp"
#include "io/raster_writer.hpp"

using namespace raster;

namespace
{

constexpr uint64_t png_side_max = 1000000; /* of libpng */
constexpr uint64_t jpeg_side_max = 65500;  /* of libjpeg */

enum image_kind kind_to_write(struct report *report, const char *path,
                              const struct raster_layout &layout)
{
    enum image_kind kind;
    if (!image_kind_of_name(path, &kind))
        throw failure{report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                                     "%s: images are written as .tif, .png or .jpg: choose one of "
                                     "these extensions",
                                     path)};
    if ((kind == IMAGE_PNG && layout.type == PIXEL_FLOAT32) ||
        (kind == IMAGE_JPEG && layout.type != PIXEL_UINT8))
        throw failure{report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                                     "%s: this format does not hold %s pixels: write .tif", path,
                                     layout.type == PIXEL_FLOAT32 ? "floating-point" : "16-bit")};
    const bool is_grey_or_colour = layout.channels == 1 || layout.channels == 3;
    if (!is_grey_or_colour && (kind != IMAGE_TIFF || layout.channels != 2))
        throw failure{report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                                     "%s: this format does not hold %u channels: write .tif with 1 "
                                     "to 3",
                                     path, layout.channels)};
    const uint64_t side_max = kind == IMAGE_PNG    ? png_side_max
                              : kind == IMAGE_JPEG ? jpeg_side_max
                                                   : uint64_t(std::numeric_limits<int>::max());
    if (layout.rows == 0 || layout.columns == 0 || layout.rows > side_max ||
        layout.columns > side_max || layout.rows > pixels_max / layout.columns)
        throw failure{report_failure(
            report, SONJECT_ERROR_UNSUPPORTED, "%s: %llu x %llu pixels cannot be written", path,
            (unsigned long long)layout.rows, (unsigned long long)layout.columns)};
    return kind;
}

/* Lines of "name=value". */
std::string describe(const struct raster_layout &layout, const char *const *channel_names,
                     const struct raster_attribute *attributes, size_t attribute_count)
{
    std::string description;
    for (uint32_t i = 0; channel_names && i < layout.channels; i++)
        description += (i == 0 ? "channels=" : ",") + std::string(channel_names[i]);
    for (size_t i = 0; i < attribute_count; i++)
        description += (description.empty() ? "" : "\n") + std::string(attributes[i].name) + "=" +
                       attributes[i].value;
    return description;
}

} // namespace

sonject_status raster_image_write(struct report *report, const char *path,
                                  const struct raster_layout *layout,
                                  const char *const *channel_names,
                                  const struct raster_attribute *attributes, size_t attribute_count,
                                  const void *pixels)
{
    return guarded(report, path, [&] {
        const enum image_kind kind = kind_to_write(report, path, *layout);
        const part_file part(path);
        const bool is_picture = layout->channels == 3;
        image_writer output(report, part.name, path, kind, *layout,
                            describe(*layout, channel_names, attributes, attribute_count),
                            is_picture);
        const uint64_t at_once = rows_at_once(*layout);
        const unsigned char *rows = static_cast<const unsigned char *>(pixels);
        for (uint64_t row = 0; row < layout->rows; row += at_once) {
            const uint64_t end = layout->rows - row < at_once ? layout->rows : row + at_once;
            output.write_rows(row, end, rows + row * row_bytes(*layout));
        }
        output.finish();
        require(file_publish(report, part.name, path));
    });
}

sonject_status raster_image_write_placed(struct report *report, const char *path,
                                         const struct raster_layout *layout,
                                         const struct region *region, const void *pixels,
                                         const uint8_t *palette)
{
    return guarded(report, path, [&] {
        const enum image_kind kind = kind_to_write(report, path, *layout);
        if (!region_is_inside(layout, region))
            throw failure{report_failure(report, SONJECT_ERROR_STORAGE,
                                         "%s: the region is not inside the image", path)};
        const part_file part(path);
        image_writer output(report, part.name, path, kind, *layout, "", true);
        const uint64_t at_once = rows_at_once(*layout);
        std::vector<unsigned char> strip(
            size_t((at_once < layout->rows ? at_once : layout->rows) * row_bytes(*layout)));
        for (uint64_t row = 0; row < layout->rows; row += at_once) {
            const uint64_t end = layout->rows - row < at_once ? layout->rows : row + at_once;
            std::memset(strip.data(), 0, strip.size());
            overlay(*layout, *region, pixels, row, end, strip.data());
            output.write_rows(row, end, strip.data());
        }
        output.finish();
        const part_file coloured(part.name);
        if (palette)
            require(png_colour(report, part.name, palette, coloured.name, path));
        require(file_publish(report, palette ? coloured.name : part.name, path));
    });
}
