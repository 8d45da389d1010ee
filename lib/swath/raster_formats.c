#include "swath/raster_formats.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/byte_order.h"
#include "base/file.h"
#include "base/memory.h"
#include "swath/hdf5_array.h"

#define NPY_HEADER 128 /* bytes, as the format wants a multiple of 64 */

enum format {
    FORMAT_TIFF,
    FORMAT_PNG,
    FORMAT_NPY,
    FORMAT_HDF5,
    FORMAT_NONE
};

static enum format format_of(const char *path)
{
    static const struct {
        const char *extension;
        enum format format;
    } formats[] = {{".tif", FORMAT_TIFF}, {".tiff", FORMAT_TIFF}, {".png", FORMAT_PNG},
                   {".npy", FORMAT_NPY},  {".h5", FORMAT_HDF5},   {".hdf5", FORMAT_HDF5}};
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < sizeof formats / sizeof *formats; i++)
        if (strcmp(dot, formats[i].extension) == 0)
            return formats[i].format;
    return FORMAT_NONE;
}

bool raster_format_keeps_attributes(const char *path)
{
    return format_of(path) != FORMAT_NPY;
}

static bool holds(enum format format, const struct raster_layout *layout)
{
    if (format == FORMAT_PNG)
        return layout->channels == 1 && layout->type != PIXEL_FLOAT32;
    return layout->channels == 1 || layout->type == PIXEL_FLOAT32;
}

sonject_status raster_format_check(struct report *report, const char *path,
                                   const struct raster_layout *layout)
{
    const enum format format = format_of(path);
    if (format == FORMAT_NONE)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: images are written without loss as .tif, .png, .npy or .h5: "
                              "choose one of these extensions",
                              path);
    if (holds(format, layout))
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: this format does not hold %s samples: write .tif, .npy or .h5, or "
                          "ask for another type and give its scale",
                          path,
                          layout->channels == 2           ? "complex"
                          : layout->type == PIXEL_FLOAT32 ? "floating-point"
                                                          : "integer");
}

static sonject_status write_plain(struct report *report, const char *path, const char *header,
                                  size_t header_bytes, const void *pixels, size_t bytes)
{
    char *part = file_part_name(path);
    if (!part)
        return report_out_of_memory(report, "a file name");
    errno = 0;
    FILE *file = fopen(part, "wb");
    bool is_written = file && fwrite(header, 1, header_bytes, file) == header_bytes &&
                      fwrite(pixels, 1, bytes, file) == bytes;
    int error = errno;
    if (file && fclose(file) != 0 && is_written) {
        is_written = false;
        error = errno;
    }
    sonject_status status;
    if (is_written) {
        status = file_publish(report, part, path);
    } else {
        status = file_failure(report, path, "write", error ? error : EIO);
        file_discard(part);
    }
    free(part);
    return status;
}

static sonject_status write_npy(struct report *report, const char *path,
                                const struct raster_layout *layout, const void *pixels)
{
    char header[NPY_HEADER + 1];
    const char *type = layout->type == PIXEL_UINT8    ? "u1"
                       : layout->type == PIXEL_UINT16 ? "u2"
                       : layout->channels == 2        ? "c8"
                                                      : "f4";
    const char order = layout->type == PIXEL_UINT8 ? '|' : machine_is_big_endian() ? '>' : '<';
    memset(header, ' ', sizeof header);
    memcpy(header, "\x93NUMPY\x01\x00\x76\x00", 10); /* 118 bytes follow */
    const int count =
        snprintf(header + 10, sizeof header - 10,
                 "{'descr': '%c%s', 'fortran_order': False, 'shape': (%llu, %llu), }", order, type,
                 (unsigned long long)layout->rows, (unsigned long long)layout->columns);
    header[10 + count] = ' ';
    header[NPY_HEADER - 1] = '\n';
    return write_plain(report, path, header, NPY_HEADER, pixels,
                       (size_t)layout->rows * (size_t)layout->columns * layout->channels *
                           pixel_bytes(layout->type));
}

sonject_status raster_format_write(struct report *report, const char *path,
                                   const struct raster_layout *layout,
                                   const struct raster_attribute *attributes,
                                   size_t attribute_count, const void *pixels)
{
    static const char *const complex_names[] = {"real", "imag"};
    const sonject_status status = raster_format_check(report, path, layout);
    if (status != SONJECT_OK)
        return status;
    switch (format_of(path)) {
    case FORMAT_NPY:
        return write_npy(report, path, layout, pixels);
    case FORMAT_HDF5:
        return hdf5_array_write(report, path, layout, attributes, attribute_count, pixels);
    default:
        return raster_file_write(report, path, layout, layout->channels == 2 ? complex_names : NULL,
                                 attributes, attribute_count, pixels);
    }
}
