#include "io/raster_source.hpp"

#include <cstring>
#include <limits>
#include <utility>

#include "io/raster_openexr.hpp"
#include "io/raster_streams.hpp"
#include "io/raster_writer.hpp"

using namespace raster;

namespace
{

/* OpenImageIO reads a JPEG from its own file or from memory. */
void choose_view(struct raster_image &file)
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

void open_input(struct report *report, struct raster_image &file)
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

void take_layout(struct report *report, struct raster_image &file)
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

} // namespace

namespace raster
{

void read_region(struct report *report, struct raster_image &file, const struct region &region,
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

std::unique_ptr<struct raster_image> open_file(struct report *report, const char *path)
{
    std::unique_ptr<struct raster_image> file(new struct raster_image);
    file->path = path;
    require(image_kind_of(report, path, &file->kind));
    require(image_kind_check(report, path, file->kind, &file->parts));
    open_input(report, *file);
    if (file->kind == IMAGE_OPENEXR)
        check_openexr(report, *file);
    take_layout(report, *file);
    return file;
}

} // namespace raster

sonject_status raster_image_open(struct report *report, const char *path,
                                 struct raster_image **image, struct raster_layout *layout,
                                 bool *is_lossless)
{
    *image = nullptr;
    return guarded(report, path, [&] {
        *image = open_file(report, path).release();
        *layout = (*image)->layout;
        *is_lossless = (*image)->kind != IMAGE_JPEG;
    });
}

void raster_image_close(struct raster_image **image)
{
    if (!image || !*image)
        return;
    try {
        (*image)->input->close();
        (*image)->input->geterror();
    } catch (...) {
        /* nothing is lost by a file that was only read */
    }
    delete *image;
    *image = nullptr;
}

bool raster_image_attribute(const struct raster_image *image, const char *name, char *value,
                            size_t capacity)
{
    try {
        const std::string description(image->spec.get_string_attribute(description_name));
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

sonject_status raster_image_read(struct report *report, struct raster_image *image,
                                 const struct region *region, void *pixels)
{
    return guarded(report, image->path.c_str(),
                   [&] { read_region(report, *image, *region, pixels); });
}
