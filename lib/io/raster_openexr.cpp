#include "io/raster_openexr.hpp"

#include <cmath>
#include <memory>
#include <string>

#include "io/raster_writer.hpp"

namespace raster
{

/* "real" of "real" and of "layer.real"; the letters' case does not matter. */
static std::string part_of_channel(const std::string &name)
{
    std::string part = name.substr(name.rfind('.') + 1);
    for (char &letter : part)
        if (letter >= 'A' && letter <= 'Z')
            letter = char(letter - 'A' + 'a');
    return part;
}

/* The format sorts channels by their names, so only these tell which is which. */
static void check_parts(struct report *report, struct raster_image &file)
{
    const std::string first = part_of_channel(file.spec.channel_name(0));
    const std::string second = part_of_channel(file.spec.channel_name(1));
    file.is_swapped = first == "imag" && second == "real";
    if (!file.is_swapped && !(first == "real" && second == "imag"))
        throw failure{
            report_failure(report, SONJECT_ERROR_INPUT,
                           "%s: its channels are named %s and %s: name them real and imag",
                           file.path.c_str(), first.c_str(), second.c_str())};
}

void check_openexr(struct report *report, struct raster_image &file)
{
    for (const OIIO::TypeDesc &type : file.spec.channelformats)
        if (type != file.spec.format)
            throw failure{report_failure(report, SONJECT_ERROR_INPUT,
                                         "%s: has channels of different types: store them in one",
                                         file.path.c_str())};
    file.is_half = file.spec.format == OIIO::TypeDesc::HALF;
    if (file.spec.nchannels == 2)
        check_parts(report, file);
}

/* What decides how chunks are coded. The rest of the header is the source's. */
static OIIO::ImageSpec chunk_spec(const OIIO::ImageSpec &source)
{
    OIIO::ImageSpec spec(source.width, source.height, source.nchannels, source.format);
    spec.x = source.x;
    spec.y = source.y;
    spec.channelnames = source.channelnames;
    spec.attribute("compression", source.get_string_attribute("compression", "none"));
    return spec;
}

void encode_openexr(const copy_order &order, struct raster_image &source, const char *encoded)
{
    const struct raster_layout &layout = source.layout;
    const uint64_t at_once = rows_at_once(layout);
    file_sink sink(encoded);
    OIIO::Filesystem::IOProxy *proxy = &sink;
    OIIO::ImageSpec spec = chunk_spec(source.spec);
    spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("openexr");
    bool is_written = output && (output->threads(1), output->open(encoded, spec));
    std::vector<unsigned char> strip(
        size_t((at_once < layout.rows ? at_once : layout.rows) * row_bytes(layout)));
    for (uint64_t row = 0; is_written && row < layout.rows; row += at_once) {
        const uint64_t end = layout.rows - row < at_once ? layout.rows : row + at_once;
        source.read(order.report, {row, 0, end - row, layout.columns}, strip.data());
        overlay(layout, *order.region, order.pixels, row, end, strip.data());
        if (source.is_swapped)
            raster_image::swap_parts(reinterpret_cast<float *>(strip.data()),
                                     (end - row) * layout.columns);
        is_written = output->write_scanlines(spec.y + int(row), spec.y + int(end), 0,
                                             OIIO::TypeDesc::FLOAT, strip.data());
        order.tell(double(end) / double(layout.rows));
    }
    is_written = is_written && output->close();
    const std::string reason = output ? output->geterror() : OIIO::geterror();
    const int error_number = sink.finish();
    if (error_number != 0)
        throw failure{file_failure(order.report, order.path, "write", error_number)};
    if (!is_written)
        throw failure{report_failure(order.report, SONJECT_ERROR_STORAGE, "%s: cannot write: %s",
                                     order.path, reason.c_str())};
}

std::vector<float> rounded_to_halves(const copy_order &order, const struct raster_layout &layout)
{
    const struct region &region = *order.region;
    const size_t row_count = size_t(region.columns) * layout.channels;
    std::vector<uint16_t> halves(row_count);
    std::vector<float> rounded(size_t(region.rows) * row_count);
    for (uint64_t row = 0; row < region.rows; row++) {
        const float *from = static_cast<const float *>(order.pixels) + row * row_count;
        float *to = rounded.data() + row * row_count;
        OIIO::convert_pixel_values(OIIO::TypeDesc::FLOAT, from, OIIO::TypeDesc::HALF, halves.data(),
                                   int(row_count));
        OIIO::convert_pixel_values(OIIO::TypeDesc::HALF, halves.data(), OIIO::TypeDesc::FLOAT, to,
                                   int(row_count));
        for (size_t i = 0; i < row_count; i++)
            if (std::isfinite(from[i]) && !std::isfinite(to[i]))
                throw failure{report_failure(
                    order.report, SONJECT_ERROR_INPUT,
                    "%s: the sample at row %llu, column %llu is %g, more than the file's 16-bit "
                    "floating point holds",
                    order.source, (unsigned long long)(region.first_row + row),
                    (unsigned long long)(region.first_column + i / layout.channels),
                    double(from[i]))};
    }
    return rounded;
}

} // namespace raster
