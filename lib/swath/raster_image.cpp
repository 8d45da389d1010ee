/* Images by OpenImageIO: JPEG, BMP and PGM that are read, JPEG that is written; and their module.
 * No exception leaves the file. */
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "base/file.h"
#include "swath/image_library.h"

namespace
{

constexpr uint64_t pixels_max = uint64_t(1) << 40;

/* Coarser coding would show in the noise of every pixel of the swath, not only near the target. */
constexpr int finest_quality = 98;

/* What keeps text attributes, as lines of "name=value": every format has it. */
constexpr const char *description_name = "ImageDescription";

/* Runs work and turns every exception into a status. */
template <typename Work> sonject_status guarded(struct report *report, const char *path, Work work)
{
    try {
        return work();
    } catch (const std::bad_alloc &) {
        return report_out_of_memory(report, path);
    } catch (const std::length_error &) {
        return report_out_of_memory(report, path);
    } catch (const std::exception &unforeseen) {
        return input_failure(report, path, "%s", unforeseen.what());
    } catch (...) {
        return input_failure(report, path, "cannot be processed");
    }
}

struct raster_image {
    std::string name; /* in messages */
    std::string path;
    enum image_kind kind;
    struct raster_layout layout;
    std::unique_ptr<OIIO::ImageInput> input;
    OIIO::ImageSpec spec;
    std::vector<unsigned char> rows;     /* decoded last, for pieces of one strip */
    uint64_t first_row = 0, end_row = 0; /* what they are; nothing if these are equal */

    size_t pixel_size() const
    {
        return layout.channels * pixel_bytes(layout.type);
    }
};

const char *format_name(enum image_kind kind)
{
    static const char *const names[] = {"tiff", "png", "jpeg", "bmp", "pnm"};
    return names[kind];
}

sonject_status open_input(struct report *report, struct raster_image &file)
{
    const char *name = file.name.c_str();
    OIIO::ImageSpec configuration;
    file.input = OIIO::ImageInput::create(format_name(file.kind));
    if (!file.input)
        return report_failure(report, SONJECT_ERROR_UNSUPPORTED, "%s: %s", name,
                              OIIO::geterror().c_str());
    file.input->threads(1);
    /* pixels as they are stored, not multiplied by anything */
    configuration.attribute("oiio:UnassociatedAlpha", 1);
    const bool is_open = file.input->open(file.path, file.spec, configuration);
    const std::string reason = file.input->geterror(); /* of warnings too */
    return is_open && reason.empty()
               ? SONJECT_OK
               : input_failure(report, name, "cannot be read: %s", reason.c_str());
}

sonject_status take_layout(struct report *report, struct raster_image &file)
{
    const OIIO::ImageSpec &spec = file.spec;
    const char *name = file.name.c_str();
    if (spec.width <= 0 || spec.height <= 0 || spec.depth > 1 ||
        uint64_t(spec.width) > pixels_max / uint64_t(spec.height))
        return input_failure(report, name,
                             "%d x %d x %d pixels are not an image that sonject reads", spec.width,
                             spec.height, spec.depth);
    if (spec.nchannels == 2)
        return input_failure(report, name,
                             "has 2 channels, grey and transparency; convert it to one channel "
                             "first");
    if (spec.nchannels != 1)
        return input_failure(report, name,
                             "has %d channels; sonject reads 1 (amplitude) or 2 (real, imaginary); "
                             "convert it to one channel first",
                             spec.nchannels);
    if (spec.format != OIIO::TypeDesc::UINT8 && spec.format != OIIO::TypeDesc::UINT16)
        return input_failure(report, name, "has pixels of type %s: convert it to TIFF",
                             spec.format.c_str());
    file.layout = {uint64_t(spec.height), uint64_t(spec.width), 1,
                   spec.format == OIIO::TypeDesc::UINT8 ? PIXEL_UINT8 : PIXEL_UINT16};
    return SONJECT_OK;
}

/* Whole rows, into file.rows. */
sonject_status decode_rows(struct report *report, struct raster_image &file, uint64_t first,
                           uint64_t end)
{
    const OIIO::ImageSpec &spec = file.spec;
    if (first == file.first_row && end == file.end_row)
        return SONJECT_OK;
    file.end_row = file.first_row;
    file.rows.resize(size_t((end - first) * file.layout.columns * file.pixel_size()));
    const bool is_read = file.input->read_scanlines(0, 0, spec.y + int(first), spec.y + int(end), 0,
                                                    0, 1, spec.format, file.rows.data());
    const std::string reason = file.input->geterror();
    if (!is_read || !reason.empty())
        return input_failure(
            report, file.name.c_str(), "cut short or damaged at rows %llu...%llu: %s",
            (unsigned long long)first, (unsigned long long)(end - 1), reason.c_str());
    file.first_row = first;
    file.end_row = end;
    return SONJECT_OK;
}

sonject_status read_region(struct report *report, struct raster_image &file,
                           const struct region &region, unsigned char *pixels)
{
    const uint64_t at_once = rows_at_once(&file.layout);
    const uint64_t end = region.first_row + region.rows;
    const size_t pixel = file.pixel_size();
    for (uint64_t first = region.first_row; first < end; first += at_once) {
        const uint64_t last = end - first < at_once ? end : first + at_once;
        CHECK(decode_rows(report, file, first, last));
        for (uint64_t row = first; row < last; row++)
            std::memcpy(pixels + (row - region.first_row) * region.columns * pixel,
                        file.rows.data() +
                            ((row - first) * file.layout.columns + region.first_column) * pixel,
                        region.columns * pixel);
    }
    return SONJECT_OK;
}

sonject_status open_file(struct report *report, struct raster_image &file)
{
    const char *name = file.name.c_str();
    const char *path = file.path.c_str();
    if (file.kind == IMAGE_BMP)
        CHECK(bmp_check(report, name, path));
    if (file.kind == IMAGE_PGM)
        CHECK(pgm_check(report, name, path));
    CHECK(open_input(report, file));
    CHECK(take_layout(report, file));
    /* Of JPEG the decoder alone tells that it is cut short: at once, not after hours of work. */
    if (file.kind == IMAGE_JPEG)
        CHECK(decode_rows(report, file, file.layout.rows - 1, file.layout.rows));
    return SONJECT_OK;
}

sonject_status raster_close(struct report *, void *image)
{
    std::unique_ptr<struct raster_image> file(static_cast<struct raster_image *>(image));
    try {
        file->input->close();
        file->input->geterror();
    } catch (...) {
        /* nothing is lost by a file that was only read */
    }
    return SONJECT_OK;
}

sonject_status raster_open(struct report *report, const char *name, const char *path, const char *,
                           bool, void **image, struct image_facts *facts)
{
    return guarded(report, name, [&] {
        std::unique_ptr<struct raster_image> file(new struct raster_image);
        file->name = name;
        file->path = path;
        file->kind = facts->kind;
        CHECK(open_file(report, *file));
        const std::string text(file->spec.get_string_attribute(description_name));
        facts->layout = file->layout;
        facts->description = copy_text(text.c_str());
        CHECK_MEMORY(report, facts->description, name);
        *image = file.release();
        return SONJECT_OK;
    });
}

sonject_status raster_read(struct report *report, void *image, const struct region *region,
                           void *pixels)
{
    auto &file = *static_cast<struct raster_image *>(image);
    return guarded(report, file.name.c_str(), [&] {
        return read_region(report, file, *region, static_cast<unsigned char *>(pixels));
    });
}

/* Where encoders write to. They must not learn of a failure, for they would print it or end the
 * process: the bytes are dropped, and whoever drives the encoder asks for the error. */
class file_sink final : public OIIO::Filesystem::IOProxy
{
  public:
    explicit file_sink(const char *path)
        : IOProxy(path, Write), file(std::fopen(path, "wb")), error(file ? 0 : errno)
    {
    }
    ~file_sink() override
    {
        finish();
    }
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
        check(error != 0 || fseeko(file, offset, SEEK_SET) == 0);
        return true;
    }
    size_t write(const void *bytes, size_t count) override
    {
        check(error != 0 || std::fwrite(bytes, 1, count, file) == count);
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
        return error;
    }
    int finish()
    {
        check(!file || std::fclose(file) == 0);
        file = nullptr;
        return error;
    }

  private:
    void check(bool is_good)
    {
        if (!is_good && error == 0)
            error = errno != 0 ? errno : EIO;
    }

    std::FILE *file;
    int error;
    int64_t position = 0;
    int64_t end = 0;
};

/* A new image in the making. */
struct raster_output {
    std::unique_ptr<file_sink> sink;
    std::unique_ptr<OIIO::ImageOutput> encoder;
};

bool open_encoder(struct raster_output &output, const struct image_encoding &encoding)
{
    const struct raster_layout &layout = encoding.layout;
    OIIO::ImageSpec spec(int(layout.columns), int(layout.rows), int(layout.channels),
                         OIIO::TypeDesc::UINT8);
    output.sink = std::make_unique<file_sink>(encoding.path);
    if (output.sink->error_so_far() != 0)
        return false;
    OIIO::Filesystem::IOProxy *proxy = output.sink.get();
    spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    const int quality = encoding.quality > 0 ? encoding.quality : finest_quality;
    char compression[32];
    std::snprintf(compression, sizeof compression, "jpeg:%d", quality);
    spec.attribute("Compression", compression);
    if (*encoding.description)
        spec.attribute(description_name, encoding.description);
    output.encoder = OIIO::ImageOutput::create(format_name(encoding.kind));
    if (!output.encoder)
        return false;
    output.encoder->threads(1);
    return output.encoder->open(encoding.path, spec);
}

sonject_status cannot_write(struct report *report, const char *name, struct raster_output &output)
{
    const std::string reason = output.encoder ? output.encoder->geterror() : OIIO::geterror();
    const int error = output.sink->finish();
    return error != 0 ? file_failure(report, name, "write", error)
                      : report_failure(report, SONJECT_ERROR_STORAGE, "%s: cannot write: %s", name,
                                       reason.c_str());
}

sonject_status write_rows(struct report *report, const struct image_encoding &encoding)
{
    const struct raster_layout &layout = encoding.layout;
    const uint64_t at_once = rows_at_once(&layout);
    struct raster_output output;
    std::vector<unsigned char> strip(
        size_t(at_once * layout.columns * layout.channels * pixel_bytes(layout.type)));
    for (uint64_t row = 0; row < layout.rows; row += at_once) {
        const uint64_t end = layout.rows - row < at_once ? layout.rows : row + at_once;
        CHECK(encoding.give_rows(encoding.user, row, end, strip.data()));
        if ((!output.encoder && !open_encoder(output, encoding)) ||
            !output.encoder->write_scanlines(int(row), int(end), 0, output.encoder->spec().format,
                                             strip.data()) ||
            output.encoder->has_error() || output.sink->error_so_far() != 0)
            return cannot_write(report, encoding.name, output);
    }
    return output.encoder->close() && !output.encoder->has_error() && output.sink->finish() == 0
               ? SONJECT_OK
               : cannot_write(report, encoding.name, output);
}

sonject_status encode(struct report *report, const struct image_encoding *encoding)
{
    return guarded(report, encoding->name, [&] { return write_rows(report, *encoding); });
}

const struct image_library openimageio = {raster_open, raster_close, raster_read, nullptr};

} // namespace

const struct raster_module raster_module_openimageio = {
    MODULE_STAMP, {nullptr, nullptr, &openimageio, &openimageio, &openimageio}, encode};
