/* An image as it is written: PNG and JPEG by OpenImageIO's encoders, TIFF by libtiff. */
#ifndef SONJECT_IO_RASTER_WRITER_HPP
#define SONJECT_IO_RASTER_WRITER_HPP

#include <cerrno>
#include <cstdint>
#include <memory>
#include <string>

#include <OpenImageIO/imageio.h>

#include "base/file.h"
#include "base/report.h"
#include "image/raster.h"
#include "swath/image_kind.h"
#include "swath/raster_failure.hpp"
#include "swath/raster_module.h"
#include "swath/raster_streams.hpp"
#include "swath/tiff_file.h"

namespace raster
{

constexpr uint64_t strip_bytes = 64u << 20; /* of rows that are in memory at a time */
constexpr uint64_t tiff_strip_bytes = 1u << 18;
constexpr uint64_t tiff_bytes_max = UINT32_MAX - (64u << 20); /* with some for its directory */
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
        : report(where), final_name(encoding.name), layout(encoding.layout)
    {
        if (encoding.kind == IMAGE_TIFF)
            open_tiff(encoding);
        else
            open_encoder(encoding);
    }

    image_writer(const image_writer &) = delete;
    image_writer &operator=(const image_writer &) = delete;

    void write_rows(uint64_t first, uint64_t end, void *pixels)
    {
        unsigned char *row = static_cast<unsigned char *>(pixels);
        if (encoder &&
            (!encoder->write_scanlines(int(first), int(end), 0, encoder->spec().format, pixels) ||
             encoder->has_error() || sink->error_so_far() != 0))
            fail();
        for (uint64_t i = first; tiff && i < end; i++, row += row_bytes(layout))
            if (TIFFWriteScanline(tiff.get(), row, uint32_t(i), 0) < 0)
                fail();
    }

    void finish()
    {
        if (tiff && !TIFFFlush(tiff.get()))
            fail();
        const bool is_closed = !encoder || (encoder->close() && !encoder->has_error());
        if (!is_closed || (sink && sink->finish() != 0))
            fail();
    }

  private:
    void open_tiff(const struct raster_encoding &encoding)
    {
        const bool is_large = layout.rows > tiff_bytes_max / row_bytes(layout);
        tiff.reset(tiff_open(encoding.path, is_large ? "w8" : "w", &fault));
        if (!tiff)
            fail();
        TIFF *file = tiff.get();
        const uint64_t rows = tiff_strip_bytes / row_bytes(layout);
        const uint16_t unspecified = EXTRASAMPLE_UNSPECIFIED;
        TIFFSetField(file, TIFFTAG_IMAGEWIDTH, uint32_t(layout.columns));
        TIFFSetField(file, TIFFTAG_IMAGELENGTH, uint32_t(layout.rows));
        TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, int(8 * pixel_bytes(layout.type)));
        TIFFSetField(file, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
        TIFFSetField(file, TIFFTAG_PHOTOMETRIC,
                     layout.channels == 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
        TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, int(layout.channels));
        TIFFSetField(file, TIFFTAG_ROWSPERSTRIP, uint32_t(rows > 0 ? rows : 1));
        TIFFSetField(file, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
        TIFFSetField(file, TIFFTAG_SOFTWARE, "sonject");
        if (layout.channels == 2)
            TIFFSetField(file, TIFFTAG_EXTRASAMPLES, 1, &unspecified);
        TIFFSetField(file, TIFFTAG_SAMPLEFORMAT,
                     layout.type == PIXEL_FLOAT32 ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
        if (*encoding.description)
            TIFFSetField(file, TIFFTAG_IMAGEDESCRIPTION, encoding.description);
    }

    void open_encoder(const struct raster_encoding &encoding)
    {
        OIIO::ImageSpec spec(int(layout.columns), int(layout.rows), int(layout.channels),
                             stored_type(layout.type));
        sink = std::make_unique<file_sink>(encoding.path);
        if (sink->error_so_far() != 0)
            fail();
        OIIO::Filesystem::IOProxy *proxy = sink.get();
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

    [[noreturn]] void fail()
    {
        const std::string reason = tiff || fault.error ? fault.message
                                   : encoder           ? encoder->geterror()
                                                       : OIIO::geterror();
        const int error_number = sink ? sink->finish() : fault.error;
        if (error_number != 0)
            throw failure{file_failure(report, final_name, "write", error_number)};
        throw failure{report_failure(report, SONJECT_ERROR_STORAGE, "%s: cannot write: %s",
                                     final_name, reason.c_str())};
    }

    struct tiff_close {
        void operator()(TIFF *file) const
        {
            TIFFClose(file);
        }
    };

    struct report *report;
    const char *final_name;
    const struct raster_layout layout;
    std::unique_ptr<file_sink> sink; /* of the encoder */
    std::unique_ptr<OIIO::ImageOutput> encoder;
    struct tiff_fault fault = {};
    std::unique_ptr<TIFF, tiff_close> tiff;
};

} // namespace raster

#endif
