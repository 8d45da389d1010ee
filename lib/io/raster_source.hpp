/* An image file that is open for reading; raster_image.h is what others see of it. Failures are
 * thrown (raster_failure.hpp). */
#ifndef SONJECT_IO_RASTER_SOURCE_HPP
#define SONJECT_IO_RASTER_SOURCE_HPP

#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "io/image_kind.h"
#include "io/raster_failure.hpp"
#include "io/raster_image.h"

struct raster_image {
    std::string path;
    enum image_kind kind;
    struct raster_layout layout;
    struct byte_ranges parts = {};
    std::unique_ptr<OIIO::Filesystem::IOProxy>
        view;                          /* if the decoder does not see the whole file */
    std::vector<unsigned char> copied; /* what it sees, where it must lie in memory */
    std::unique_ptr<OIIO::ImageInput> input;
    OIIO::ImageSpec spec;
    std::vector<unsigned char> rows;     /* decoded last, for pieces of one strip */
    uint64_t first_row = 0, end_row = 0; /* what they are; nothing if these are equal */
    bool is_half = false;                /* stored as 16-bit floating point */
    bool is_swapped = false;             /* the imaginary part is stored before the real one */

    raster_image() = default;
    ~raster_image()
    {
        input.reset();
        std::free(parts.list);
    }
    raster_image(const raster_image &) = delete;
    raster_image &operator=(const raster_image &) = delete;

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
                path.c_str(), (unsigned long long)region.first_row,
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

#endif
