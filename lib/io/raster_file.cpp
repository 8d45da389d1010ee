extern "C" {
#include "base/file.h"
#include "base/report.h"
#include "image/raster.h"
}
#include "io/raster_file.h"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "io/byte_file.h"
#include "io/image_kind.h"
#include "io/jpeg_segments.h"
#include "io/png_chunks.h"
#include "io/tiff_head.h"
#include "io/tiff_patch.h"
#include "io/tiff_structure.h"

namespace
{

constexpr uint64_t strip_bytes = 64u << 20;
constexpr int png_filter_none = 8;          /* of libpng */
constexpr uint64_t png_side_max = 1000000;  /* of libpng */
constexpr uint64_t jpeg_side_max = 65500;   /* of libjpeg */
constexpr size_t give_up_bytes = 64 * 1024; /* a PNG's pixels come in chunks of 8 KB */
constexpr uint64_t pixels_max = uint64_t(1) << 40;

/* Coarser coding would show in the noise of every pixel of the swath, not only near the target. */
constexpr const char *jpeg_quality = "jpeg:98";

/* What keeps text attributes, as lines of "name=value": every format has it. */
constexpr const char *description_name = "ImageDescription";

/* Thrown where a report has the message already. */
struct failure {
    sonject_status status;
};

void require(sonject_status status)
{
    if (status != SONJECT_OK)
        throw failure{status};
}

/* Runs work and turns every exception into a status. */
template <typename Work> sonject_status guarded(struct report *report, const char *path, Work work)
{
    try {
        work();
        return SONJECT_OK;
    } catch (const failure &known) {
        return known.status;
    } catch (const std::bad_alloc &) {
        return report_out_of_memory(report, path);
    } catch (const std::length_error &) {
        return report_out_of_memory(report, path);
    } catch (const std::exception &unforeseen) {
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: %s", path, unforeseen.what());
    } catch (...) {
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: cannot be processed", path);
    }
}

OIIO::TypeDesc stored_type(enum pixel_type type)
{
    switch (type) {
    case PIXEL_UINT8:
        return OIIO::TypeDesc::UINT8;
    case PIXEL_UINT16:
        return OIIO::TypeDesc::UINT16;
    case PIXEL_FLOAT32:
        break;
    }
    return OIIO::TypeDesc::FLOAT;
}

const char *format_name(enum image_kind kind)
{
    switch (kind) {
    case IMAGE_PNG:
        return "png";
    case IMAGE_JPEG:
        return "jpeg";
    case IMAGE_TIFF:
        break;
    }
    return "tiff";
}

/* A file name that is removed when it goes out of scope, unless it was published before. */
class part_file
{
  public:
    explicit part_file(const char *path) : name(file_part_name(path))
    {
        if (!name)
            throw std::bad_alloc();
    }
    ~part_file()
    {
        file_discard(name);
        std::free(name);
    }
    part_file(const part_file &) = delete;
    part_file &operator=(const part_file &) = delete;

    char *const name;
};

/* Where encoders write to. They must not learn of a failure, for they would print it or end the
 * process: the bytes are dropped, and whoever drives the encoder asks for the error. */
class file_sink final : public OIIO::Filesystem::IOProxy
{
  public:
    explicit file_sink(const char *path)
        : IOProxy(path, Write), file(std::fopen(path, "wb")), error_number(file ? 0 : errno)
    {
    }
    ~file_sink() override
    {
        finish();
    }
    file_sink(const file_sink &) = delete;
    file_sink &operator=(const file_sink &) = delete;

    /* not "file": OpenImageIO would take this for a proxy of its own and look for a FILE in it */
    const char *proxytype() const override
    {
        return "sink";
    }
    int64_t tell() override
    {
        return position;
    }
    bool seek(int64_t offset) override
    {
        position = offset;
        if (file && error_number == 0)
            check(fseeko(file, offset, SEEK_SET) == 0);
        return true;
    }
    size_t write(const void *bytes, size_t count) override
    {
        if (file && error_number == 0)
            check(std::fwrite(bytes, 1, count, file) == count);
        position += int64_t(count);
        end = position > end ? position : end;
        return count;
    }
    size_t size() const override
    {
        return size_t(end);
    }

    /* 0, or the errno of the first failure. */
    int error_so_far() const
    {
        return error_number;
    }
    int finish()
    {
        if (file && std::fclose(file) != 0)
            check(false);
        file = nullptr;
        return error_number;
    }

  private:
    void check(bool is_good)
    {
        if (!is_good && error_number == 0)
            error_number = errno != 0 ? errno : EIO;
    }

    std::FILE *file;
    int error_number;
    int64_t position = 0;
    int64_t end = 0;
};

/* Parts of a file as if there were nothing between them. */
class file_view final : public OIIO::Filesystem::IOProxy
{
  public:
    /* parts must stay where they are */
    file_view(const std::string &path, const struct byte_ranges &chosen)
        : IOProxy(path, Read), parts(chosen), file(byte_file_open(path.c_str(), &file_bytes))
    {
        for (size_t i = 0; i < parts.count; i++)
            total += parts.list[i].count;
    }
    ~file_view() override
    {
        if (file)
            std::fclose(file);
    }
    file_view(const file_view &) = delete;
    file_view &operator=(const file_view &) = delete;

    const char *proxytype() const override
    {
        return "view";
    }
    int64_t tell() override
    {
        return position;
    }
    bool seek(int64_t offset) override
    {
        position = offset;
        return offset >= 0;
    }
    size_t read(void *bytes, size_t count) override
    {
        const size_t got = pread(bytes, count, position);
        position += int64_t(got);
        return got;
    }
    size_t pread(void *bytes, size_t count, int64_t offset) override
    {
        unsigned char *to = static_cast<unsigned char *>(bytes);
        size_t got = 0;
        uint64_t start = uint64_t(offset);
        for (size_t i = 0; file && i < parts.count && got < count; i++) {
            const struct byte_range &part = parts.list[i];
            if (start >= part.count) {
                start -= part.count;
                continue;
            }
            const uint64_t left = part.count - start;
            const size_t some = left < count - got ? size_t(left) : count - got;
            if (!byte_file_read(file, part.place + start, to + got, some))
                break;
            got += some;
            start = 0;
        }
        return got;
    }
    size_t size() const override
    {
        return size_t(total);
    }

  private:
    const struct byte_ranges &parts;
    uint64_t file_bytes = 0;
    std::FILE *file;
    uint64_t total = 0;
    int64_t position = 0;
};

uint64_t row_bytes(const struct raster_layout &layout)
{
    return layout.columns * layout.channels * pixel_bytes(layout.type);
}

uint64_t rows_at_once(const struct raster_layout &layout)
{
    const uint64_t rows = strip_bytes / row_bytes(layout);
    return rows > 0 ? rows : 1;
}

/* An image as it is written, row by row. */
class image_writer
{
  public:
    /* description: a text that the file keeps; name: of the finished file, for messages */
    image_writer(struct report *where, const char *path, const char *name, enum image_kind kind,
                 const struct raster_layout &image, const std::string &description,
                 bool is_mask = false)
        : report(where), final_name(name), layout(image), is_png(kind == IMAGE_PNG), sink(path)
    {
        if (sink.error_so_far() != 0)
            fail();
        if (kind == IMAGE_TIFF)
            write_head(description);
        else
            open_encoder(path, kind, description, is_mask);
    }

    /* libpng prints a complaint where an image is given up before its first pixels are in the file.
     */
    ~image_writer()
    {
        try {
            for (uint32_t noise = 1;
                 is_png && !is_finished && sink.size() < give_up_bytes && next_row < layout.rows;) {
                std::vector<unsigned char> row(size_t(row_bytes(layout)));
                for (unsigned char &byte : row)
                    byte =
                        static_cast<unsigned char>((noise = noise * 1664525u + 1013904223u) >> 24);
                write_rows(next_row, next_row + 1, row.data());
            }
        } catch (...) {
            /* it is given up anyway */
        }
    }
    image_writer(const image_writer &) = delete;
    image_writer &operator=(const image_writer &) = delete;

    void write_rows(uint64_t first, uint64_t end, const void *pixels)
    {
        next_row = end;
        const bool is_written = encoder
                                    ? encoder->write_scanlines(int(first), int(end), 0,
                                                               encoder->spec().format, pixels) &&
                                          !encoder->has_error()
                                    : write(pixels, (end - first) * row_bytes(layout));
        if (!is_written || sink.error_so_far() != 0)
            fail();
    }

    void finish()
    {
        is_finished = true;
        const bool is_closed = !encoder || (encoder->close() && !encoder->has_error());
        if (sink.finish() != 0 || !is_closed)
            fail();
    }

  private:
    void write_head(const std::string &description)
    {
        size_t count = 0;
        const std::unique_ptr<unsigned char, decltype(&std::free)> head(
            tiff_make_head(&layout, description.c_str(), &count), &std::free);
        if (!head)
            throw std::bad_alloc();
        if (!write(head.get(), count))
            fail();
    }

    void open_encoder(const char *path, enum image_kind kind, const std::string &description,
                      bool is_mask)
    {
        OIIO::ImageSpec spec(int(layout.columns), int(layout.rows), int(layout.channels),
                             stored_type(layout.type));
        OIIO::Filesystem::IOProxy *proxy = &sink;
        spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
        if (kind == IMAGE_JPEG)
            spec.attribute("Compression", jpeg_quality);
        if (!description.empty())
            spec.attribute(description_name, description);
        if (is_mask) { /* mostly zeros: nothing is gained by trying hard */
            spec.attribute("png:filter", png_filter_none);
            spec.attribute("png:compressionLevel", 1);
        }
        encoder = OIIO::ImageOutput::create(format_name(kind));
        if (!encoder)
            fail();
        encoder->threads(1);
        if (!encoder->open(path, spec))
            fail();
    }

    bool write(const void *bytes, uint64_t count)
    {
        sink.write(bytes, size_t(count));
        return sink.error_so_far() == 0;
    }

    [[noreturn]] void fail()
    {
        const std::string reason = encoder ? encoder->geterror() : OIIO::geterror();
        const int error_number = sink.finish();
        if (error_number != 0)
            throw failure{file_failure(report, final_name, "write", error_number)};
        throw failure{report_failure(report, SONJECT_ERROR_STORAGE, "%s: cannot write: %s",
                                     final_name, reason.c_str())};
    }

    struct report *report;
    const char *final_name;
    const struct raster_layout layout;
    const bool is_png;
    bool is_finished = false;
    uint64_t next_row = 0;
    file_sink sink;
    std::unique_ptr<OIIO::ImageOutput> encoder; /* none for TIFF */
};

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
    image_writer output(order.report, encoded, order.path, source.kind, layout, "");
    std::vector<unsigned char> strip(
        size_t((at_once < layout.rows ? at_once : layout.rows) * row_bytes(layout)));
    for (uint64_t row = 0; row < layout.rows; row += at_once) {
        const uint64_t end = layout.rows - row < at_once ? layout.rows : row + at_once;
        source.read(order.report, {row, 0, end - row, layout.columns}, strip.data());
        overlay(layout, *order.region, order.pixels, row, end, strip.data());
        output.write_rows(row, end, strip.data());
        order.tell(double(end) / double(layout.rows));
    }
    output.finish();
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

/* Whatever went into the copy must come out of it: a file that says contradictory things of itself
 * may fool the writer, but not the reader as well. */
void check_copy(const copy_order &order, const struct raster_file &source, const char *result)
{
    size_t bytes = 0;
    const std::unique_ptr<struct raster_file> copy = open_file(order.report, result);
    if (!region_bytes(&source.layout, order.region, &bytes))
        throw std::bad_alloc();
    std::vector<unsigned char> pixels(bytes);
    read_region(order.report, *copy, *order.region, pixels.data());
    if (raster_file_is_lossless(copy.get()) && std::memcmp(pixels.data(), order.pixels, bytes) != 0)
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
        check_copy(order, *file, part.name);
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
