/* An image as it is written: PNG, JPEG and JPEG 2000 by OpenImageIO's encoders, TIFF plainly. */
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
    case IMAGE_JPEG2000:
        return "jpeg2000";
    case IMAGE_OPENEXR:
        return "openexr";
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

/* Puts the part of the patch that lies in rows first...end over these rows. */
inline void overlay(const struct raster_layout &layout, const struct region &region,
                    const void *patch, uint64_t first, uint64_t end, unsigned char *rows)
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

/* An image as it is written, row by row. To be made when the first rows are there: libpng prints a
 * complaint about a PNG that is given up without any. */
class image_writer
{
  public:
    /* description: a text that the file keeps; name: of the finished file, for messages; is_drawn:
     * a mask or a picture, not an image of measured pixels */
    image_writer(struct report *where, const char *path, const char *name, enum image_kind kind,
                 const struct raster_layout &image, const std::string &description,
                 bool is_drawn = false)
        : report(where), final_name(name), layout(image), sink(path)
    {
        if (sink.error_so_far() != 0)
            fail();
        if (kind == IMAGE_TIFF)
            write_head(description);
        else
            open_encoder(path, kind, description, is_drawn);
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
                      bool is_drawn)
    {
        OIIO::ImageSpec spec(int(layout.columns), int(layout.rows), int(layout.channels),
                             stored_type(layout.type));
        OIIO::Filesystem::IOProxy *proxy = &sink;
        spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
        if (kind == IMAGE_JPEG)
            spec.attribute("Compression", jpeg_quality);
        if (!description.empty())
            spec.attribute(description_name, description);
        if (is_drawn) { /* few values, or noise by way of a colour map: filters and searching for
                         * longer matches cost much time, and make files no smaller */
            spec.attribute("png:filter", png_filter_none);
            spec.attribute("png:compressionLevel", 1);
        }
        encoder = OIIO::ImageOutput::create(format_name(kind));
        if (!encoder)
            fail();
        encoder->threads(1);
        /* the encoder of JPEG 2000 tells by the name what to write, and leaves others empty */
        if (!encoder->open(kind == IMAGE_JPEG2000 ? "encoded.jp2" : path, spec))
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
