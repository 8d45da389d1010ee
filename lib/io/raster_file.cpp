#include "io/raster_file.h"

#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "io/image_kind.h"
#include "io/jpeg_segments.h"
#include "io/png_chunks.h"
#include "io/raster_failure.hpp"
#include "io/raster_streams.hpp"
#include "io/raster_writer.hpp"
#include "io/tiff_patch.h"

using namespace raster;

namespace
{

constexpr uint64_t png_side_max = 1000000; /* of libpng */
constexpr uint64_t jpeg_side_max = 65500;  /* of libjpeg */
constexpr uint64_t pixels_max = uint64_t(1) << 40;

/* Puts the part of the patch that lies in rows first...end over these rows. */
void overlay(const struct raster_layout &layout, const struct region &region, const void *patch,
             uint64_t first, uint64_t end, unsigned char *rows)
{
    const uint64_t pixel = layout.channels * pixel_bytes(layout.type);
    const uint64_t from = first > region.first_row ? first : region.first_row;
    const uint64_t region_end = region.first_row + region.rows;
    const uint64_t to = end < region_end ? end : region_end;
    for (uint64_t row = from; row < to; row++)
        std::memcpy(rows + (row - first) * row_bytes(layout) + region.first_column * pixel,
                    static_cast<const unsigned char *>(patch) +
                        (row - region.first_row) * region.columns * pixel,
                    region.columns * pixel);
}

} // namespace

struct raster_file {
    std::string path;
    enum image_kind kind;
    struct raster_layout layout;
    struct byte_ranges parts = {};
    std::unique_ptr<OIIO::Filesystem::IOProxy>
        view;                          /* if the decoder does not see the whole file */
    std::vector<unsigned char> copied; /* what it sees, where it must lie in memory */
    std::unique_ptr<OIIO::ImageInput> input;
    OIIO::ImageSpec spec;

    raster_file() = default;
    ~raster_file()
    {
        input.reset();
        std::free(parts.list);
    }
    raster_file(const raster_file &) = delete;
    raster_file &operator=(const raster_file &) = delete;

    /* Reads whole rows (from a tiled image: those columns) into pixels. */
    void read(struct report *report, const struct region &region, void *pixels)
    {
        const int x = spec.x + int(region.first_column);
        const int y = spec.y + int(region.first_row);
        const int x_end = x + int(region.columns);
        const int y_end = y + int(region.rows);
        const bool is_read =
            spec.tile_width > 0
                ? input->read_tiles(0, 0, x, x_end, y, y_end, 0, 1, 0, spec.nchannels, spec.format,
                                    pixels)
                : input->read_scanlines(0, 0, y, y_end, 0, 0, spec.nchannels, spec.format, pixels);
        const std::string reason = input->geterror();
        if (!is_read || !reason.empty())
            throw failure{report_failure(
                report, SONJECT_ERROR_INPUT, "%s: cut short or damaged at rows %llu...%llu: %s",
                path.c_str(), (unsigned long long)region.first_row,
                (unsigned long long)(region.first_row + region.rows - 1), reason.c_str())};
    }
};

namespace
{

/* OpenImageIO reads a JPEG from its own file or from memory. */
void choose_view(struct raster_file &file)
{
    std::unique_ptr<file_view> view = std::make_unique<file_view>(file.path, file.parts);
    if (file.kind == IMAGE_JPEG) {
        file.copied.resize(view->size());
        file.copied.resize(view->pread(file.copied.data(), file.copied.size(), 0));
        file.view =
            std::make_unique<OIIO::Filesystem::IOMemReader>(file.copied.data(), file.copied.size());
    } else {
        file.view = std::move(view);
    }
}

void open_input(struct report *report, struct raster_file &file)
{
    const char *path = file.path.c_str();
    OIIO::ImageSpec configuration;
    file.input = OIIO::ImageInput::create(format_name(file.kind));
    if (!file.input) {
        const std::string reason = OIIO::geterror();
        throw failure{
            report_failure(report, SONJECT_ERROR_UNSUPPORTED, "%s: %s", path, reason.c_str())};
    }
    file.input->threads(1);
    /* pixels as they are stored, not multiplied by anything */
    configuration.attribute("oiio:UnassociatedAlpha", 1);
    if (file.parts.count > 0) {
        choose_view(file);
        OIIO::Filesystem::IOProxy *proxy = file.view.get();
        configuration.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    }
    const bool is_open = file.input->open(file.path, file.spec, configuration);
    const std::string reason = file.input->geterror(); /* of warnings too */
    if (!is_open || !reason.empty())
        throw failure{report_failure(report, SONJECT_ERROR_INPUT, "%s: cannot be read: %s", path,
                                     reason.c_str())};
}

void take_layout(struct report *report, struct raster_file &file)
{
    const OIIO::ImageSpec &spec = file.spec;
    const char *path = file.path.c_str();
    if (spec.width <= 0 || spec.height <= 0 || spec.depth > 1 ||
        uint64_t(spec.width) > pixels_max / uint64_t(spec.height))
        throw failure{report_failure(report, SONJECT_ERROR_INPUT,
                                     "%s: %d x %d x %d pixels are not an image that sonject reads",
                                     path, spec.width, spec.height, spec.depth)};
    if (spec.nchannels != 1 && spec.nchannels != 2)
        throw failure{report_failure(report, SONJECT_ERROR_INPUT,
                                     "%s: has %d channels; sonject reads 1 (amplitude) or 2 (real, "
                                     "imaginary); convert it to one channel first",
                                     path, spec.nchannels)};
    file.layout.rows = uint64_t(spec.height);
    file.layout.columns = uint64_t(spec.width);
    file.layout.channels = uint32_t(spec.nchannels);
    if (spec.format == OIIO::TypeDesc::UINT8)
        file.layout.type = PIXEL_UINT8;
    else if (spec.format == OIIO::TypeDesc::UINT16)
        file.layout.type = PIXEL_UINT16;
    else if (spec.format == OIIO::TypeDesc::FLOAT)
        file.layout.type = PIXEL_FLOAT32;
    else
        throw failure{report_failure(report, SONJECT_ERROR_INPUT,
                                     "%s: has pixels of type %s; sonject reads 8 and 16 bit "
                                     "unsigned and 32 bit float: convert it to one of these",
                                     path, spec.format.c_str())};
}

/* Rows that are decoded together. From within a strip libtiff does not start where channels are
 * stored apart. */
uint64_t rows_of_strip(const struct raster_file &file)
{
    const bool is_compressed = file.spec.get_string_attribute("compression") != "none";
    const int rows = file.spec.get_int_attribute("tiff:RowsPerStrip", 1);
    return file.kind == IMAGE_TIFF && is_compressed && rows > 1 ? uint64_t(rows) : 1;
}

/* Rows of an image without tiles: whole ones, of which the region's columns are kept. */
void read_by_rows(struct report *report, struct raster_file &file, const struct region &region,
                  unsigned char *pixels)
{
    const uint64_t pixel = file.layout.channels * pixel_bytes(file.layout.type);
    const uint64_t unit = rows_of_strip(file);
    const uint64_t some = rows_at_once(file.layout) / unit * unit;
    const uint64_t at_once = some > 0 ? some : unit;
    const uint64_t region_end = region.first_row + region.rows;
    const uint64_t wanted_end = (region_end - 1) / unit * unit + unit;
    const uint64_t end = wanted_end < file.layout.rows ? wanted_end : file.layout.rows;
    const uint64_t start = region.first_row / unit * unit;
    const uint64_t kept = region.columns * pixel;
    std::vector<unsigned char> rows(
        size_t((at_once < end - start ? at_once : end - start) * row_bytes(file.layout)));
    for (uint64_t first = start; first < end; first += at_once) {
        const uint64_t last = end - first < at_once ? end : first + at_once;
        file.read(report, {first, 0, last - first, file.layout.columns}, rows.data());
        for (uint64_t row = first; row < last; row++)
            if (row >= region.first_row && row < region_end)
                std::memcpy(pixels + (row - region.first_row) * kept,
                            rows.data() + (row - first) * row_bytes(file.layout) +
                                region.first_column * pixel,
                            kept);
    }
}

/* One tile after the other. */
void read_by_tiles(struct report *report, struct raster_file &file, const struct region &region,
                   unsigned char *pixels)
{
    const uint64_t pixel = file.layout.channels * pixel_bytes(file.layout.type);
    const uint64_t height = uint64_t(file.spec.tile_height);
    const uint64_t width = uint64_t(file.spec.tile_width);
    const uint64_t row_end = region.first_row + region.rows;
    const uint64_t column_end = region.first_column + region.columns;
    std::vector<unsigned char> tile(size_t(height * width * pixel));
    for (uint64_t row = region.first_row / height * height; row < row_end; row += height)
        for (uint64_t column = region.first_column / width * width; column < column_end;
             column += width) {
            const uint64_t rows = file.layout.rows - row < height ? file.layout.rows - row : height;
            const uint64_t columns =
                file.layout.columns - column < width ? file.layout.columns - column : width;
            file.read(report, {row, column, rows, columns}, tile.data());
            const uint64_t first = row > region.first_row ? row : region.first_row;
            const uint64_t last = row + rows < row_end ? row + rows : row_end;
            const uint64_t left = column > region.first_column ? column : region.first_column;
            const uint64_t right = column + columns < column_end ? column + columns : column_end;
            for (uint64_t i = first; i < last; i++)
                std::memcpy(pixels + ((i - region.first_row) * region.columns +
                                      (left - region.first_column)) *
                                         pixel,
                            tile.data() + ((i - row) * columns + (left - column)) * pixel,
                            (right - left) * pixel);
        }
}

void read_region(struct report *report, struct raster_file &file, const struct region &region,
                 void *pixels)
{
    if (!region_is_inside(&file.layout, &region))
        throw failure{report_failure(report, SONJECT_ERROR_INPUT,
                                     "%s: the region is not inside the image", file.path.c_str())};
    if (file.spec.tile_width > 0)
        read_by_tiles(report, file, region, static_cast<unsigned char *>(pixels));
    else
        read_by_rows(report, file, region, static_cast<unsigned char *>(pixels));
}

std::unique_ptr<struct raster_file> open_file(struct report *report, const char *path)
{
    std::unique_ptr<struct raster_file> file(new struct raster_file);
    file->path = path;
    require(image_kind_of(report, path, &file->kind));
    require(image_kind_check(report, path, file->kind, &file->parts));
    open_input(report, *file);
    take_layout(report, *file);
    return file;
}

} // namespace

sonject_status raster_file_open(struct report *report, const char *path, struct raster_file **file)
{
    *file = nullptr;
    return guarded(report, path, [&] { *file = open_file(report, path).release(); });
}

void raster_file_close(struct raster_file **file)
{
    if (!file || !*file)
        return;
    try {
        (*file)->input->close();
        (*file)->input->geterror();
    } catch (...) {
        /* nothing is lost by a file that was only read */
    }
    delete *file;
    *file = nullptr;
}

void raster_file_layout(const struct raster_file *file, struct raster_layout *layout)
{
    *layout = file->layout;
}

bool raster_file_is_lossless(const struct raster_file *file)
{
    return file->kind != IMAGE_JPEG;
}

bool raster_file_attribute(const struct raster_file *file, const char *name, char *value,
                           size_t capacity)
{
    try {
        const std::string description(file->spec.get_string_attribute(description_name));
        const std::string lines = "\n" + description + "\n";
        const std::string start = "\n" + std::string(name) + "=";
        const size_t line = lines.find(start);
        if (line == std::string::npos)
            return false;
        const size_t first = line + start.size();
        const size_t count = lines.find('\n', first) - first;
        if (count >= capacity)
            return false;
        std::memcpy(value, lines.data() + first, count);
        value[count] = '\0';
        return true;
    } catch (...) {
        return false;
    }
}

sonject_status raster_file_read(struct report *report, struct raster_file *file,
                                const struct region *region, void *pixels)
{
    return guarded(report, file->path.c_str(),
                   [&] { read_region(report, *file, *region, pixels); });
}

namespace
{

struct copy_order {
    struct report *report;
    const char *source, *path;
    const struct region *region;
    const void *pixels;
    sonject_progress_function progress;
    void *user;

    void tell(double fraction) const
    {
        if (progress && progress(user, fraction, "write") != 0)
            throw failure{report_failure(report, SONJECT_CANCELLED, "cancelled")};
    }
};

/* Decodes and encodes the image, a strip of rows at a time. */
void encode_copy(const copy_order &order, struct raster_file &source, const char *encoded)
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

void copy_encoded(const copy_order &order, struct raster_file &source, const char *result)
{
    const part_file encoded(result);
    encode_copy(order, source, encoded.name);
    if (source.kind == IMAGE_PNG)
        require(png_join(order.report, order.source, encoded.name, result, order.path));
    else
        require(jpeg_join(order.report, order.source, encoded.name, result, order.path));
}

struct region_reader {
    struct report *report;
    struct raster_file *file;
};

sonject_status read_for_tiff(void *user, const struct region *region, void *pixels)
{
    const region_reader *reader = static_cast<const region_reader *>(user);
    return raster_file_read(reader->report, reader->file, region, pixels);
}

void copy_tiff(const copy_order &order, struct raster_file &source, const char *result)
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
    const std::unique_ptr<struct raster_file> copy = open_file(order.report, path);
    if (!region_bytes(&copy->layout, order.region, &bytes))
        throw std::bad_alloc();
    std::vector<unsigned char> pixels(bytes);
    read_region(order.report, *copy, *order.region, pixels.data());
    return !raster_file_is_lossless(copy.get()) ||
           std::memcmp(pixels.data(), order.pixels, bytes) == 0;
}

/* Whatever went into the copy must come out of it: a file that says contradictory things of itself
 * may fool the writer, but not the reader as well. */
void check_copy(const copy_order &order, const char *path)
{
    bool is_good = false;
    try {
        is_good = holds_patch(order, path);
    } catch (const failure &known) {
        if (known.status != SONJECT_ERROR_INPUT)
            throw;
    }
    if (!is_good)
        throw failure{report_failure(order.report, SONJECT_ERROR_INPUT,
                                     "%s: damaged: its pixels cannot be replaced", order.source)};
}

} // namespace

sonject_status raster_file_copy_with_patch(struct report *report, const char *source,
                                           const char *path, const struct region *region,
                                           const void *pixels, sonject_progress_function progress,
                                           void *user)
{
    return guarded(report, path, [&] {
        const copy_order order = {report, source, path, region, pixels, progress, user};
        const std::unique_ptr<struct raster_file> file = open_file(report, source);
        if (!region_is_inside(&file->layout, region))
            throw failure{report_failure(report, SONJECT_ERROR_INPUT,
                                         "%s: the region is not inside the image", source)};
        const part_file part(path);
        if (file->kind == IMAGE_TIFF)
            copy_tiff(order, *file, part.name);
        else
            copy_encoded(order, *file, part.name);
        check_copy(order, part.name);
        require(file_publish(report, part.name, path));
    });
}

namespace
{

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

sonject_status raster_file_write(struct report *report, const char *path,
                                 const struct raster_layout *layout,
                                 const char *const *channel_names,
                                 const struct raster_attribute *attributes, size_t attribute_count,
                                 const void *pixels)
{
    return guarded(report, path, [&] {
        const enum image_kind kind = kind_to_write(report, path, *layout);
        const part_file part(path);
        image_writer output(report, part.name, path, kind, *layout,
                            describe(*layout, channel_names, attributes, attribute_count));
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

sonject_status raster_file_write_placed(struct report *report, const char *path,
                                        const struct raster_layout *layout,
                                        const struct region *region, const void *pixels)
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
        require(file_publish(report, part.name, path));
    });
}
