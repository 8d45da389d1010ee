#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include <OpenImageIO/imageio.h>

extern "C" {
#include "base/file.h"
#include "io/raster_file.h"
}

namespace
{

constexpr uint64_t strip_bytes_limit = uint64_t(64) << 20;
constexpr uint64_t pixels_limit = uint64_t(1) << 40;

/* Runs a body that may throw; nothing leaves it but a status. */
template <typename Body> sonject_status guarded(struct report *report, const char *path, Body body)
{
    try {
        return body();
    } catch (const std::bad_alloc &) {
        return report_failure(report, SONJECT_ERROR_MEMORY, "out of memory for %s", path);
    } catch (const std::exception &problem) {
        return report_failure(report, SONJECT_ERROR_STORAGE, "%s: %s", path, problem.what());
    } catch (...) {
        return report_failure(report, SONJECT_ERROR_STORAGE, "%s: unknown failure", path);
    }
}

OIIO::TypeDesc type_of(enum pixel_type type)
{
    switch (type) {
    case PIXEL_UINT8:
        return OIIO::TypeDesc::UINT8;
    case PIXEL_UINT16:
        return OIIO::TypeDesc::UINT16;
    default:
        return OIIO::TypeDesc::FLOAT;
    }
}

bool take_type(const OIIO::TypeDesc &type, enum pixel_type *taken)
{
    if (type == OIIO::TypeDesc::UINT8)
        *taken = PIXEL_UINT8;
    else if (type == OIIO::TypeDesc::UINT16)
        *taken = PIXEL_UINT16;
    else if (type == OIIO::TypeDesc::FLOAT)
        *taken = PIXEL_FLOAT32;
    else
        return false;
    return true;
}

/* Deleting an open ImageOutput closes it; the part is discarded unless it was published. */
struct output_part {
    char *name;
    explicit output_part(const char *path) : name(file_part_name(path))
    {
        if (!name)
            throw std::bad_alloc();
    }
    output_part(const output_part &) = delete;
    output_part &operator=(const output_part &) = delete;
    ~output_part()
    {
        if (name)
            file_discard(name);
        free(name);
    }
    sonject_status publish(struct report *report, const char *path)
    {
        const sonject_status status = file_publish(report, name, path);
        free(name);
        name = nullptr;
        return status;
    }
};

} // namespace

struct raster_file {
    std::unique_ptr<OIIO::ImageInput> input;
    OIIO::ImageSpec spec;
    struct raster_layout layout;
    std::string path;
    bool has_more_images;
};

namespace
{

sonject_status refuse(struct report *report, const char *path, const std::string &problem)
{
    return report_failure(report, SONJECT_ERROR_INPUT, "%s: %s", path, problem.c_str());
}

sonject_status check_spec(struct report *report, const char *path, const OIIO::ImageSpec &spec,
                          struct raster_layout *layout)
{
    if (spec.width < 1 || spec.height < 1 || spec.depth > 1)
        return refuse(report, path, "has no pixels or is a volume");
    layout->rows = uint64_t(spec.height);
    layout->columns = uint64_t(spec.width);
    if (layout->rows > pixels_limit / layout->columns)
        return refuse(report, path, "claims more than 2^40 pixels; the file is damaged");
    if (spec.nchannels != 1 && spec.nchannels != 2)
        return refuse(report, path,
                      "has " + std::to_string(spec.nchannels) +
                          " channels; convert it to 1 (amplitude) or 2 (real, imaginary)");
    layout->channels = uint32_t(spec.nchannels);
    if (spec.alpha_channel >= 0)
        return refuse(report, path, "has an alpha channel; convert it to 1 channel without alpha");
    if (!spec.channelformats.empty() || !take_type(spec.format, &layout->type))
        return refuse(report, path,
                      std::string("has pixels of type ") + spec.format.c_str() +
                          "; convert it to 8 or 16 bit unsigned or 32 bit float");
    const int bits = spec.get_int_attribute("oiio:BitsPerSample", 0);
    if (bits != 0 && size_t(bits) != 8 * pixel_bytes(layout->type))
        return refuse(report, path,
                      "has " + std::to_string(bits) + " bits a pixel; convert it to 8, 16 or 32");
    return SONJECT_OK;
}

/* Reads whole rows [first, last) of the columns [left, right); tiled files need tile borders. */
bool read_block(raster_file &file, uint64_t first, uint64_t last, uint64_t left, uint64_t right,
                void *pixels)
{
    const OIIO::ImageSpec &spec = file.spec;
    const OIIO::TypeDesc type = type_of(file.layout.type);
    if (spec.tile_width > 0)
        return file.input->read_tiles(0, 0, spec.x + int(left), spec.x + int(right),
                                      spec.y + int(first), spec.y + int(last), 0, 1, 0,
                                      spec.nchannels, type, pixels);
    return file.input->read_scanlines(0, 0, spec.y + int(first), spec.y + int(last), 0, 0,
                                      spec.nchannels, type, pixels);
}

uint64_t round_up(uint64_t value, uint64_t step, uint64_t limit)
{
    const uint64_t rounded = (value + step - 1) / step * step;
    return rounded < limit ? rounded : limit;
}

/* How many rows a strip of whole width may have: within the limit, whole tiles. */
uint64_t strip_rows(const OIIO::ImageSpec &spec, uint64_t row_bytes)
{
    const uint64_t step = spec.tile_height > 0 ? uint64_t(spec.tile_height) : 1;
    const uint64_t fitting = strip_bytes_limit / (row_bytes > 0 ? row_bytes : 1);
    return fitting < step ? step : fitting / step * step;
}

sonject_status read_failure(struct report *report, const raster_file &file)
{
    return refuse(report, file.path.c_str(),
                  "cannot be read, it may be cut short or damaged: " + file.input->geterror());
}

sonject_status read_region(struct report *report, raster_file &file, const struct region &region,
                           unsigned char *pixels)
{
    const OIIO::ImageSpec &spec = file.spec;
    const bool is_tiled = spec.tile_width > 0;
    const uint64_t tile_width = is_tiled ? uint64_t(spec.tile_width) : 1;
    const uint64_t tile_height = is_tiled ? uint64_t(spec.tile_height) : 1;
    const uint64_t left = is_tiled ? region.first_column / tile_width * tile_width : 0;
    const uint64_t right = is_tiled ? round_up(region.first_column + region.columns, tile_width,
                                               file.layout.columns)
                                    : file.layout.columns;
    const size_t pixel = file.layout.channels * pixel_bytes(file.layout.type);
    const size_t block_row = size_t(right - left) * pixel;
    const size_t region_row = size_t(region.columns) * pixel;
    const uint64_t end = region.first_row + region.rows;
    const uint64_t rows = strip_rows(spec, block_row);
    std::vector<unsigned char> block;
    for (uint64_t first = region.first_row / tile_height * tile_height; first < end;) {
        const uint64_t last =
            first + rows < end ? first + rows : round_up(end, tile_height, file.layout.rows);
        block.resize(size_t(last - first) * block_row);
        if (!read_block(file, first, last, left, right, block.data()))
            return read_failure(report, file);
        for (uint64_t row = first; row < last; row++)
            if (row >= region.first_row && row < end)
                std::memcpy(pixels + size_t(row - region.first_row) * region_row,
                            block.data() + size_t(row - first) * block_row +
                                size_t(region.first_column - left) * pixel,
                            region_row);
        first = last;
    }
    return SONJECT_OK;
}

/* Puts the part of a patch that lies in the rows [first, last) into a block of whole rows. */
void put_patch(std::vector<unsigned char> &block, const struct raster_layout &layout,
               const struct region &region, const unsigned char *pixels, uint64_t first,
               uint64_t last)
{
    const size_t pixel = layout.channels * pixel_bytes(layout.type);
    const size_t row_bytes = size_t(layout.columns) * pixel;
    const size_t region_row = size_t(region.columns) * pixel;
    for (uint64_t row = first; row < last; row++)
        if (row >= region.first_row && row - region.first_row < region.rows)
            std::memcpy(block.data() + size_t(row - first) * row_bytes +
                            size_t(region.first_column) * pixel,
                        pixels + size_t(row - region.first_row) * region_row, region_row);
}

bool write_block(OIIO::ImageOutput &output, const OIIO::ImageSpec &spec, OIIO::TypeDesc type,
                 uint64_t first, uint64_t last, const void *pixels)
{
    if (output.spec().tile_width > 0)
        return output.write_tiles(spec.x, spec.x + spec.width, spec.y + int(first),
                                  spec.y + int(last), 0, 1, type, pixels);
    return output.write_scanlines(spec.y + int(first), spec.y + int(last), 0, type, pixels);
}

sonject_status write_failure(struct report *report, const char *path, const std::string &problem)
{
    return report_failure(report, SONJECT_ERROR_STORAGE, "%s: cannot write: %s", path,
                          problem.c_str());
}

std::unique_ptr<OIIO::ImageOutput> create_output(struct report *report, const char *part,
                                                 const char *path, const OIIO::ImageSpec &spec,
                                                 sonject_status *status)
{
    auto output = OIIO::ImageOutput::create(part);
    *status = SONJECT_OK;
    if (!output) {
        *status = report_failure(report, SONJECT_ERROR_UNSUPPORTED, "%s: %s", path,
                                 OIIO::geterror().c_str());
        return output;
    }
    output->threads(1);
    if (!output->open(part, spec))
        *status = write_failure(report, path, output->geterror());
    return output;
}

/* Streams rows: `fill` puts the rows [first, last) into the block. */
template <typename Fill>
sonject_status write_rows(struct report *report, const char *path, const OIIO::ImageSpec &spec,
                          const struct raster_layout &layout, Fill fill)
{
    output_part part(path);
    sonject_status status;
    auto output = create_output(report, part.name, path, spec, &status);
    if (status != SONJECT_OK)
        return status;
    const size_t row_bytes = size_t(layout.columns) * layout.channels * pixel_bytes(layout.type);
    const uint64_t rows = strip_rows(output->spec(), row_bytes);
    std::vector<unsigned char> block;
    for (uint64_t first = 0; first < layout.rows; first += rows) {
        const uint64_t last = first + rows < layout.rows ? first + rows : layout.rows;
        block.assign(size_t(last - first) * row_bytes, 0);
        status = fill(block, first, last);
        if (status != SONJECT_OK)
            return status;
        if (!write_block(*output, spec, type_of(layout.type), first, last, block.data()))
            return write_failure(report, path, output->geterror());
    }
    if (!output->close())
        return write_failure(report, path, output->geterror());
    output.reset();
    return part.publish(report, path);
}

OIIO::ImageSpec spec_of(const struct raster_layout &layout)
{
    return OIIO::ImageSpec(int(layout.columns), int(layout.rows), int(layout.channels),
                           type_of(layout.type));
}

} // namespace

extern "C" sonject_status raster_file_open(struct report *report, const char *path,
                                           struct raster_file **file)
{
    *file = nullptr;
    if (!file_exists(path))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: no such file: correct input.path or give it with --set "
                              "input.path=...",
                              path);
    return guarded(report, path, [&]() {
        auto input = OIIO::ImageInput::open(path);
        if (!input)
            return refuse(report, path, "cannot be read as an image: " + OIIO::geterror());
        input->threads(1);
        std::unique_ptr<raster_file> opened(new raster_file);
        opened->spec = input->spec();
        opened->path = path;
        const sonject_status status = check_spec(report, path, opened->spec, &opened->layout);
        if (status != SONJECT_OK)
            return status;
        opened->has_more_images = input->seek_subimage(1, 0);
        input->seek_subimage(0, 0);
        (void)input->geterror(); /* that there is no second image is no error */
        opened->input = std::move(input);
        *file = opened.release();
        return SONJECT_OK;
    });
}

extern "C" void raster_file_close(struct raster_file **file)
{
    if (!file)
        return;
    delete *file;
    *file = nullptr;
}

extern "C" void raster_file_layout(const struct raster_file *file, struct raster_layout *layout)
{
    *layout = file->layout;
}

extern "C" bool raster_file_is_lossless(const struct raster_file *file)
{
    return std::strcmp(file->input->format_name(), "jpeg") != 0 &&
           file->spec.get_string_attribute("compression").find("jpeg") == std::string::npos;
}

extern "C" bool raster_file_attribute(const struct raster_file *file, const char *name, char *value,
                                      size_t capacity)
{
    const std::string text = "\n" + std::string(file->spec.get_string_attribute("ImageDescription"));
    const std::string key = "\n" + std::string(name) + "=";
    const size_t at = text.find(key);
    if (at == std::string::npos)
        return false;
    const size_t start = at + key.size();
    const std::string found = text.substr(start, text.find('\n', start) - start);
    if (found.size() >= capacity)
        return false;
    std::memcpy(value, found.c_str(), found.size() + 1);
    return true;
}

extern "C" sonject_status raster_file_read(struct report *report, struct raster_file *file,
                                           const struct region *region, void *pixels)
{
    return guarded(report, file->path.c_str(), [&]() {
        return read_region(report, *file, *region, static_cast<unsigned char *>(pixels));
    });
}

extern "C" sonject_status raster_file_copy_with_patch(struct report *report, const char *source,
                                                      const char *path, const struct region *region,
                                                      const void *pixels,
                                                      sonject_progress_function progress,
                                                      void *user)
{
    struct raster_file *file;
    const sonject_status opened = raster_file_open(report, source, &file);
    if (opened != SONJECT_OK)
        return opened;
    const sonject_status status = guarded(report, path, [&]() {
        if (file->has_more_images)
            return refuse(report, source, "holds several images; split it into single ones first");
        OIIO::ImageSpec spec = file->spec;
        if (!raster_file_is_lossless(file))
            spec.attribute("Compression", "jpeg:98");
        return write_rows(
            report, path, spec, file->layout,
            [&](std::vector<unsigned char> &block, uint64_t first, uint64_t last) {
                if (progress && progress(user, double(first) / double(file->layout.rows),
                                         "writing the swath"))
                    return report_failure(report, SONJECT_CANCELLED,
                                          "cancelled while writing %s", path);
                if (!read_block(*file, first, last, 0, file->layout.columns, block.data()))
                    return read_failure(report, *file);
                put_patch(block, file->layout, *region,
                          static_cast<const unsigned char *>(pixels), first, last);
                return SONJECT_OK;
            });
    });
    raster_file_close(&file);
    return status;
}

extern "C" sonject_status raster_file_write(struct report *report, const char *path,
                                            const struct raster_layout *layout,
                                            const char *const *channel_names,
                                            const struct raster_attribute *attributes,
                                            size_t attribute_count, const void *pixels)
{
    return guarded(report, path, [&]() {
        OIIO::ImageSpec spec = spec_of(*layout);
        if (channel_names) {
            spec.channelnames.assign(channel_names, channel_names + layout->channels);
            spec.alpha_channel = -1;
        }
        /* TIFF and PNG keep no names of our own, but both keep a description */
        std::string description;
        for (size_t i = 0; i < attribute_count; i++)
            description += std::string(attributes[i].name) + "=" + attributes[i].value + "\n";
        if (!description.empty())
            spec.attribute("ImageDescription", description);
        const size_t row_bytes =
            size_t(layout->columns) * layout->channels * pixel_bytes(layout->type);
        return write_rows(report, path, spec, *layout,
                          [&](std::vector<unsigned char> &block, uint64_t first, uint64_t) {
                              std::memcpy(block.data(),
                                          static_cast<const unsigned char *>(pixels) +
                                              size_t(first) * row_bytes,
                                          block.size());
                              return SONJECT_OK;
                          });
    });
}

extern "C" sonject_status raster_file_write_placed(struct report *report, const char *path,
                                                   const struct raster_layout *layout,
                                                   const struct region *region, const void *pixels)
{
    return guarded(report, path, [&]() {
        OIIO::ImageSpec spec = spec_of(*layout);
        return write_rows(report, path, spec, *layout,
                          [&](std::vector<unsigned char> &block, uint64_t first, uint64_t last) {
                              put_patch(block, *layout, *region,
                                        static_cast<const unsigned char *>(pixels), first, last);
                              return SONJECT_OK;
                          });
    });
}
