
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>

#include <sonject/version.h>

#include "base/byte_file.h"
#include "swath/plain_head.h"
#include "swath/png_palette.h"
#include "swath/raster_failure.hpp"
#include "swath/raster_streams.hpp"
#include "swath/raster_writer.hpp"

namespace
{

struct raster_image {
    std::string name; /* in messages */
    std::string path;
    enum image_kind kind;
    struct raster_layout layout;
    std::vector<unsigned char> numbers; /* a PNG that stands for the file; none where empty */
    std::unique_ptr<OIIO::Filesystem::IOProxy> view; /* of these */
    std::unique_ptr<OIIO::ImageInput> input;
    OIIO::ImageSpec spec;
    std::vector<unsigned char> rows;     /* decoded last, for pieces of one strip */
    uint64_t first_row = 0, end_row = 0; /* what they are; nothing if these are equal */
    bool is_half = false;                /* stored as 16-bit floating point */
    bool is_swapped = false;             /* the imaginary part is stored before the real one */

    /* Reads whole rows (from a tiled image: those columns) into pixels. */
    void read(struct report *report, const struct region &region, void *pixels)
    {
        const OIIO::TypeDesc type = is_half ? OIIO::TypeDesc::FLOAT : spec.format;
        const int x = spec.x + int(region.first_column);
        const int y = spec.y + int(region.first_row);
        const int x_end = x + int(region.columns);
        const int y_end = y + int(region.rows);
        const bool is_read =
            spec.tile_width > 0
                ? input->read_tiles(0, 0, x, x_end, y, y_end, 0, 1, 0, spec.nchannels, type, pixels)
                : input->read_scanlines(0, 0, y, y_end, 0, 0, spec.nchannels, type, pixels);
        const std::string reason = input->geterror();
        if (!is_read || !reason.empty())
            throw raster::failure{report_failure(
                report, SONJECT_ERROR_INPUT, "%s: cut short or damaged at rows %llu...%llu: %s",
                name.c_str(), (unsigned long long)region.first_row,
                (unsigned long long)(region.first_row + region.rows - 1), reason.c_str())};
        if (is_swapped)
            swap_parts(static_cast<float *>(pixels), region.rows * region.columns);
    }

    /* Between the file's order and real, imaginary. */
    static void swap_parts(float *parts, uint64_t count)
    {
        for (uint64_t i = 0; i < count; i++)
            std::swap(parts[2 * i], parts[2 * i + 1]);
    }
};

using namespace raster;

/* A coloured PNG as the grey one that it was made of. */
void restore_numbers(struct raster_image &file)
{
    uint64_t bytes = 0;
    FILE *source = byte_file_open(file.path.c_str(), &bytes);
    file.numbers.resize(source ? size_t(bytes) : 0);
    const bool is_read = source && byte_file_read(source, 0, file.numbers.data(), size_t(bytes));
    if (source)
        std::fclose(source);
    if (!is_read || bytes < PNG_COLOURED_BYTES)
        file.numbers.assign(PNG_COLOURED_BYTES, 0);
    const auto start = file.numbers.begin();
    file.numbers.erase(start + PNG_NUMBERS_PLACE + PNG_HEADER_BYTES, start + PNG_COLOURED_BYTES);
    file.numbers.erase(start + PNG_HEADER_PLACE, start + PNG_NUMBERS_PLACE);
    file.view =
        std::make_unique<OIIO::Filesystem::IOMemReader>(file.numbers.data(), file.numbers.size());
}

void open_input(struct report *report, struct raster_image &file)
{
    const char *path = file.name.c_str();
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
    OIIO::Filesystem::IOProxy *proxy = file.view.get();
    if (proxy)
        configuration.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    const bool is_open = file.input->open(file.path, file.spec, configuration);
    const std::string reason = file.input->geterror(); /* of warnings too */
    if (!is_open || !reason.empty())
        throw failure{report_failure(report, SONJECT_ERROR_INPUT, "%s: cannot be read: %s", path,
                                     reason.c_str())};
}

/* "real" of "real" and of "layer.real"; the letters' case does not matter. */
std::string part_of_channel(const std::string &name)
{
    return OIIO::Strutil::lower(name.substr(name.rfind('.') + 1));
}

/* What OpenEXR itself takes. The format has no checksums: a window that a damaged byte changed is
 * told by the other one. Channels are sorted by their names, so only these tell which is which. */
void check_openexr(struct report *report, struct raster_image &file)
{
    const OIIO::ImageSpec &spec = file.spec;
    const char *fault = nullptr;
    if (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
        spec.height != spec.full_height)
        fault = "its data window is not its display window: write the whole image";
    else if (spec.deep || file.input->seek_subimage(1, 0))
        fault = "has several parts or depths: write the image alone";
    else if (!spec.channelformats.empty())
        fault = "has channels of different types: store them in one";
    file.input->seek_subimage(0, 0);
    file.input->geterror(); /* that there is no other part */
    file.is_half = spec.format == OIIO::TypeDesc::HALF;
    if (!fault && spec.nchannels == 2) {
        const std::string first = part_of_channel(spec.channel_name(0));
        const std::string second = part_of_channel(spec.channel_name(1));
        file.is_swapped = first == "imag" && second == "real";
        if (!file.is_swapped && !(first == "real" && second == "imag"))
            fault = "has two channels: name them real and imag";
    }
    if (fault)
        throw failure{
            report_failure(report, SONJECT_ERROR_INPUT, "%s: %s", file.name.c_str(), fault)};
}

void take_layout(struct report *report, struct raster_image &file)
{
    const OIIO::ImageSpec &spec = file.spec;
    const char *path = file.name.c_str();
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
    if (spec.nchannels == 2 && spec.alpha_channel >= 0)
        throw failure{report_failure(report, SONJECT_ERROR_INPUT,
                                     "%s: has 2 channels, grey and transparency; convert it to one "
                                     "channel first",
                                     path)};
    file.layout.rows = uint64_t(spec.height);
    file.layout.columns = uint64_t(spec.width);
    file.layout.channels = uint32_t(spec.nchannels);
    if (spec.format == OIIO::TypeDesc::UINT8)
        file.layout.type = PIXEL_UINT8;
    else if (spec.format == OIIO::TypeDesc::UINT16)
        file.layout.type = PIXEL_UINT16;
    else if (spec.format == OIIO::TypeDesc::FLOAT || file.is_half)
        file.layout.type = PIXEL_FLOAT32;
    else
        throw failure{report_failure(report, SONJECT_ERROR_INPUT,
                                     "%s: has pixels of type %s; sonject reads 8 and 16 bit "
                                     "unsigned and 32 bit float: convert it to one of these",
                                     path, spec.format.c_str())};
}

/* Rows that are decoded together. From within a strip libtiff does not start where channels are
 * stored apart. */
uint64_t rows_of_strip(const struct raster_image &file)
{
    const bool is_compressed = file.spec.get_string_attribute("compression") != "none";
    const int rows = file.spec.get_int_attribute("tiff:RowsPerStrip", 1);
    return file.kind == IMAGE_TIFF && is_compressed && rows > 1 ? uint64_t(rows) : 1;
}

/* Rows of an image without tiles: whole ones, of which the region's columns are kept. */
void read_by_rows(struct report *report, struct raster_image &file, const struct region &region,
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
    std::vector<unsigned char> &rows = file.rows;
    for (uint64_t first = start; first < end; first += at_once) {
        const uint64_t last = end - first < at_once ? end : first + at_once;
        if (first != file.first_row || last != file.end_row) {
            file.end_row = 0;
            rows.resize(size_t((last - first) * row_bytes(file.layout)));
            file.read(report, {first, 0, last - first, file.layout.columns}, rows.data());
            file.first_row = first;
            file.end_row = last;
        }
        for (uint64_t row = first; row < last; row++)
            if (row >= region.first_row && row < region_end)
                std::memcpy(pixels + (row - region.first_row) * kept,
                            rows.data() + (row - first) * row_bytes(file.layout) +
                                region.first_column * pixel,
                            kept);
    }
}

/* One tile after the other. */
void read_by_tiles(struct report *report, struct raster_image &file, const struct region &region,
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

void read_region(struct report *report, struct raster_image &file, const struct region &region,
                 void *pixels)
{
    if (file.spec.tile_width > 0)
        read_by_tiles(report, file, region, static_cast<unsigned char *>(pixels));
    else
        read_by_rows(report, file, region, static_cast<unsigned char *>(pixels));
}

/* Of PNG and JPEG the decoder alone tells that they are cut short: at once,
 * not after hours of work. */
void decode_to_the_end(struct report *report, struct raster_image &file)
{
    file.rows.resize(size_t(row_bytes(file.layout)));
    file.read(report, {file.layout.rows - 1, 0, 1, file.layout.columns}, file.rows.data());
}

std::unique_ptr<struct raster_image> open_file(struct report *report, const char *name,
                                               const char *path)
{
    std::unique_ptr<struct raster_image> file(new struct raster_image);
    file->name = name;
    file->path = path;
    unsigned char head[16];
    uint64_t bytes = 0;
    FILE *stream = byte_file_open(path, &bytes);
    const size_t count = stream ? std::fread(head, 1, sizeof head, stream) : 0;
    const int error = stream && !std::ferror(stream) ? 0 : errno;
    if (stream)
        std::fclose(stream);
    if (error != 0)
        throw failure{file_refuse(report, name, error)};
    if (!image_kind_of_beginning(head, count, &file->kind))
        throw failure{image_kind_refuse(report, name, head, count)};
    bool is_coloured = false;
    if (file->kind == IMAGE_TIFF)
        require(tiff_check(report, name, path));
    if (file->kind == IMAGE_PNG)
        require(png_check(report, name, path, &is_coloured));
    if (file->kind == IMAGE_BMP)
        require(bmp_check(report, path));
    if (file->kind == IMAGE_PNM)
        require(pnm_check(report, path));
    if (is_coloured)
        restore_numbers(*file);
    open_input(report, *file);
    if (file->kind == IMAGE_OPENEXR)
        check_openexr(report, *file);
    take_layout(report, *file);
    if (file->kind == IMAGE_PNG || file->kind == IMAGE_JPEG)
        decode_to_the_end(report, *file);
    return file;
}

void raster_close(void *image)
{
    std::unique_ptr<struct raster_image> file(static_cast<struct raster_image *>(image));
    try {
        file->input->close();
        file->input->geterror();
    } catch (...) {
        /* nothing is lost by a file that was only read */
    }
}

sonject_status raster_open(struct report *report, const char *name, const char *path, const char *,
                           bool, void **image, struct image_facts *facts)
{
    *image = nullptr;
    return guarded(report, name, [&] {
        auto file = open_file(report, name, path);
        *facts = {file->layout, 0, false};
        *image = file.release();
    });
}

char *raster_attribute(void *image, const char *name)
{
    try {
        const std::string description(
            static_cast<struct raster_image *>(image)->spec.get_string_attribute(description_name));
        if (!*name)
            return strdup(description.c_str());
        const std::string lines = "\n" + description + "\n";
        const std::string start = "\n" + std::string(name) + "=";
        const size_t line = lines.find(start);
        if (line == std::string::npos)
            return nullptr;
        const size_t first = line + start.size();
        return strdup(lines.substr(first, lines.find('\n', first) - first).c_str());
    } catch (...) {
        return nullptr;
    }
}

sonject_status raster_read(struct report *report, void *image, const struct region *region,
                           void *pixels)
{
    auto &file = *static_cast<struct raster_image *>(image);
    return guarded(report, file.name.c_str(), [&] { read_region(report, file, *region, pixels); });
}

sonject_status raster_change(struct report *report, void *image, const struct region *region,
                             const void *pixels)
{
    const auto &file = *static_cast<const struct raster_image *>(image);
    if (file.kind != IMAGE_TIFF)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: is no TIFF", file.name.c_str());
    return tiff_change(report, file.name.c_str(), file.path.c_str(), region, pixels);
}

sonject_status raster_finish(struct report *, void *)
{
    return SONJECT_OK;
}

sonject_status raster_encode(struct report *report, const struct raster_encoding *encoding)
{
    return guarded(report, encoding->name, [&] {
        const struct raster_layout &layout = encoding->layout;
        const uint64_t at_once = rows_at_once(layout);
        std::unique_ptr<image_writer> output;
        std::vector<unsigned char> strip(
            size_t((at_once < layout.rows ? at_once : layout.rows) * row_bytes(layout)));
        for (uint64_t row = 0; row < layout.rows; row += at_once) {
            const uint64_t end = layout.rows - row < at_once ? layout.rows : row + at_once;
            require(encoding->give_rows(encoding->user, row, end, strip.data()));
            if (!output)
                output = std::make_unique<image_writer>(report, *encoding);
            output->write_rows(row, end, strip.data());
        }
        output->finish();
    });
}

} // namespace

#define TEXT_OF(number)   #number
#define DIGITS_OF(number) TEXT_OF(number)

const struct raster_module raster_module_openimageio = {
    RASTER_MODULE_MARK,
    sizeof(struct raster_module),
    sizeof(struct report),
    sizeof(struct raster_encoding),
    DIGITS_OF(SONJECT_VERSION_MAJOR) "." DIGITS_OF(SONJECT_VERSION_MINOR) "." DIGITS_OF(
        SONJECT_VERSION_PATCH),
    {raster_open, raster_close, raster_attribute, raster_read, raster_change, raster_finish},
    raster_encode,
};
