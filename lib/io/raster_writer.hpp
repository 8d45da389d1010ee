/* An image as it is written: PNG and JPEG by OpenImageIO's encoders, TIFF plainly. */
#ifndef SONJECT_IO_RASTER_WRITER_HPP
#define SONJECT_IO_RASTER_WRITER_HPP

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <string>

#include <OpenImageIO/imageio.h>

#include "base/file.h"
#include "base/report.h"
#include "image/raster.h"
#include "io/image_kind.h"
#include "io/raster_failure.hpp"
#include "io/raster_image.h"
#include "io/raster_streams.hpp"
#include "io/tiff_head.h"

namespace raster
{

constexpr uint64_t strip_bytes = 64u << 20; /* of rows that are in memory at a time */
constexpr uint64_t pixels_max = uint64_t(1) << 40;
constexpr int png_filter_none = 8; /* of libpng */

/* Coarser coding would show in the noise of every pixel of the swath, not only near the target. */
constexpr const char *jpeg_quality = "jpeg:98";

/* What keeps text attributes, as lines of "name=value": every format has it. */
constexpr const char *description_name = "ImageDescription";

inline OIIO::TypeDesc stored_type(enum pixel_type type)
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

inline const char *format_name(enum image_kind kind)
{
    switch (kind) {
    case IMAGE_PNG:
        return "png";
    case IMAGE_JPEG:
        return "jpeg";
    case IMAGE_OPENEXR:
        return "openexr";
    case IMAGE_BMP:
        return "bmp";
    case IMAGE_PNM:
        return "pnm";
    case IMAGE_TIFF:
        break;
    }
    return "tiff";
}

inline uint64_t row_bytes(const struct raster_layout &layout)
{
    return layout.columns * layout.channels * pixel_bytes(layout.type);
}

inline uint64_t rows_at_once(const struct raster_layout &layout)
{
    const uint64_t rows = strip_bytes / row_bytes(layout);
    return rows > 0 ? rows : 1;
}

/* An image as it is written, row by row. To be made when the first rows are there: libpng prints a
 * complaint about a PNG that is given up without any. */
class image_writer
{
  public:
    image_writer(struct report *where, const struct raster_encoding &encoding)
        : report(where), final_name(encoding.name), layout(encoding.layout), sink(encoding.path)
    {
        if (sink.error_so_far() != 0)
            fail();
        if (encoding.kind == IMAGE_TIFF)
            write_head(encoding.description);
        else
            open_encoder(encoding);
    }

    image_writer(const image_writer &) = delete;
    image_writer &operator=(const image_writer &) = delete;

    void write_rows(uint64_t first, uint64_t end, const void *pixels)
    {
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
        const bool is_closed = !encoder || (encoder->close() && !encoder->has_error());
        if (sink.finish() != 0 || !is_closed)
            fail();
    }

  private:
    void write_head(const char *description)
    {
        size_t count = 0;
        const std::unique_ptr<unsigned char, decltype(&std::free)> head(
            tiff_make_head(&layout, description, &count), &std::free);
        if (!head)
            throw std::bad_alloc();
        if (!write(head.get(), count))
            fail();
    }

    void open_encoder(const struct raster_encoding &encoding)
    {
        OIIO::ImageSpec spec(int(layout.columns), int(layout.rows), int(layout.channels),
                             stored_type(layout.type));
        OIIO::Filesystem::IOProxy *proxy = &sink;
        spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
        if (encoding.kind == IMAGE_JPEG)
            spec.attribute("Compression", jpeg_quality);
        if (*encoding.description)
            spec.attribute(description_name, encoding.description);
        if (encoding
                .is_drawn) { /* few values, or noise by way of a colour map: filters and searching
                              * for longer matches cost much time, and make files no smaller */
            spec.attribute("png:filter", png_filter_none);
            spec.attribute("png:compressionLevel", 1);
        }
        encoder = OIIO::ImageOutput::create(format_name(encoding.kind));
        if (!encoder)
            fail();
        encoder->threads(1);
        if (!encoder->open(encoding.path, spec))
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
    file_sink sink;
    std::unique_ptr<OIIO::ImageOutput> encoder; /* none for TIFF */
};

} // namespace raster

#endif
