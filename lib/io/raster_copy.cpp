/* A copy of an image file in which a region holds other pixels. */
#include "io/raster_source.hpp"

#include <cstring>
#include <new>

#include "io/exr_chunks.h"
#include "io/jp2_boxes.h"
#include "io/jpeg_segments.h"
#include "io/png_chunks.h"
#include "io/raster_openexr.hpp"
#include "io/raster_writer.hpp"
#include "io/tiff_patch.h"

using namespace raster;

namespace
{

/* Decodes and encodes the image, a strip of rows at a time. */
void encode_copy(const copy_order &order, struct raster_image &source, const char *encoded)
{
    const struct raster_layout &layout = source.layout;
    const uint64_t at_once = rows_at_once(layout);
    std::unique_ptr<image_writer> output;
    std::vector<unsigned char> strip(
        size_t((at_once < layout.rows ? at_once : layout.rows) * row_bytes(layout)));
    for (uint64_t row = 0; row < layout.rows; row += at_once) {
        const uint64_t end = layout.rows - row < at_once ? layout.rows : row + at_once;
        source.read(order.report, {row, 0, end - row, layout.columns}, strip.data());
        overlay(layout, *order.region, order.pixels, row, end, strip.data());
        if (!output)
            output = std::make_unique<image_writer>(order.report, encoded, order.path, source.kind,
                                                    layout, "");
        output->write_rows(row, end, strip.data());
        order.tell(double(end) / double(layout.rows));
    }
    output->finish();
}

void copy_encoded(const copy_order &order, struct raster_image &source, const char *result)
{
    const part_file encoded(result);
    if (source.kind == IMAGE_OPENEXR) {
        encode_openexr(order, source, encoded.name);
        require(
            exr_join(order.report, order.source, encoded.name, order.region, result, order.path));
        return;
    }
    encode_copy(order, source, encoded.name);
    if (source.kind == IMAGE_PNG)
        require(png_join(order.report, order.source, encoded.name, result, order.path));
    else if (source.kind == IMAGE_JPEG2000)
        require(jp2_join(order.report, order.source, encoded.name, result, order.path));
    else
        require(jpeg_join(order.report, order.source, encoded.name, result, order.path));
}

struct region_reader {
    struct report *report;
    struct raster_image *file;
};

sonject_status read_for_tiff(void *user, const struct region *region, void *pixels)
{
    const region_reader *reader = static_cast<const region_reader *>(user);
    return raster_image_read(reader->report, reader->file, region, pixels);
}

void copy_tiff(const copy_order &order, struct raster_image &source, const char *result)
{
    region_reader reader = {order.report, &source};
    const struct tiff_patch patch = {order.source,  result,         order.path,
                                     *order.region, order.pixels,   read_for_tiff,
                                     &reader,       order.progress, order.user};
    require(tiff_copy_with_patch(order.report, &patch));
}

bool holds_patch(const copy_order &order, const char *path)
{
    size_t bytes = 0;
    const std::unique_ptr<struct raster_image> copy = open_file(order.report, path);
    if (!region_bytes(&copy->layout, order.region, &bytes))
        throw std::bad_alloc();
    std::vector<unsigned char> pixels(bytes);
    read_region(order.report, *copy, *order.region, pixels.data());
    return copy->kind == IMAGE_JPEG || std::memcmp(pixels.data(), order.pixels, bytes) == 0;
}

/* A JPEG 2000 is coded anew as a whole, by an encoder that loses nothing: seen, not believed. */
bool holds_all(const copy_order &order, struct raster_image &source, const char *path)
{
    const struct raster_layout &layout = source.layout;
    const uint64_t at_once = rows_at_once(layout);
    const size_t bytes =
        size_t((at_once < layout.rows ? at_once : layout.rows) * row_bytes(layout));
    const std::unique_ptr<struct raster_image> copy = open_file(order.report, path);
    std::vector<unsigned char> expected(bytes);
    std::vector<unsigned char> found(bytes);
    for (uint64_t row = 0; row < layout.rows; row += at_once) {
        const uint64_t end = layout.rows - row < at_once ? layout.rows : row + at_once;
        const struct region strip = {row, 0, end - row, layout.columns};
        source.read(order.report, strip, expected.data());
        overlay(layout, *order.region, order.pixels, row, end, expected.data());
        read_region(order.report, *copy, strip, found.data());
        if (std::memcmp(expected.data(), found.data(), size_t((end - row) * row_bytes(layout))) !=
            0)
            return false;
    }
    return true;
}

/* Whatever went into the copy must come out of it: a file that says contradictory things of itself
 * may fool the writer, but not the reader as well. */
void check_copy(const copy_order &order, struct raster_image &source, const char *path)
{
    bool is_good = false;
    try {
        is_good = source.kind == IMAGE_JPEG2000 ? holds_all(order, source, path)
                                                : holds_patch(order, path);
    } catch (const failure &known) {
        if (known.status != SONJECT_ERROR_INPUT)
            throw;
    }
    if (!is_good)
        throw failure{report_failure(order.report, SONJECT_ERROR_INPUT,
                                     "%s: damaged: its pixels cannot be replaced", order.source)};
}

} // namespace

sonject_status raster_image_copy_with_patch(struct report *report, const char *source,
                                            const char *path, const struct region *region,
                                            const void *pixels, sonject_progress_function progress,
                                            void *user)
{
    return guarded(report, path, [&] {
        copy_order order = {report, source, path, region, pixels, progress, user};
        const std::unique_ptr<struct raster_image> file = open_file(report, source);
        if (!region_is_inside(&file->layout, region))
            throw failure{report_failure(report, SONJECT_ERROR_INPUT,
                                         "%s: the region is not inside the image", source)};
        std::vector<float> halves;
        if (file->is_half) {
            halves = rounded_to_halves(order, file->layout);
            order.pixels = halves.data();
        }
        const part_file part(path);
        if (file->kind == IMAGE_TIFF)
            copy_tiff(order, *file, part.name);
        else
            copy_encoded(order, *file, part.name);
        check_copy(order, *file, part.name);
        require(file_publish(report, part.name, path));
    });
}
