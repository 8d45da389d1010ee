#include "io/raster_formats.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/growing_text.h"
#include "base/memory.h"
#include "io/byte_order.h"
#include "io/hdf5_array.h"

#define NPY_HEADER 128 /* bytes, as the format wants a multiple of 64 */

enum format {
    FORMAT_TIFF,
    FORMAT_PNG,
    FORMAT_NPY,
    FORMAT_HDF5,
    FORMAT_PGM,
    FORMAT_PFM,
    FORMAT_NONE
};

static enum format format_of(const char *path)
{
    static const struct {
        const char *extension;
        enum format format;
    } formats[] = {{".tif", FORMAT_TIFF}, {".tiff", FORMAT_TIFF}, {".png", FORMAT_PNG},
                   {".npy", FORMAT_NPY},  {".h5", FORMAT_HDF5},   {".hdf5", FORMAT_HDF5},
                   {".pgm", FORMAT_PGM},  {".pfm", FORMAT_PFM}};
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < sizeof formats / sizeof *formats; i++)
        if (strcmp(dot, formats[i].extension) == 0)
            return formats[i].format;
    return FORMAT_NONE;
}

bool raster_format_keeps_attributes(const char *path)
{
    return format_of(path) != FORMAT_NPY && format_of(path) != FORMAT_PFM;
}

static bool holds(enum format format, const struct raster_layout *layout)
{
    switch (format) {
    case FORMAT_PNG:
    case FORMAT_PGM:
        return layout->channels == 1 && layout->type != PIXEL_FLOAT32;
    case FORMAT_PFM:
        return layout->channels == 1 && layout->type == PIXEL_FLOAT32;
    default:
        return layout->channels == 1 || layout->type == PIXEL_FLOAT32;
    }
}

sonject_status raster_format_check(struct report *report, const char *path,
                                   const struct raster_layout *layout)
{
    const enum format format = format_of(path);
    if (format == FORMAT_NONE)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: images are written without loss as .tif, .png, .npy, .h5, .pgm "
                              "or .pfm: choose one of these extensions",
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

/* A file that is a header and rows of samples. */
struct plain_file {
    const char *path;
    const char *header;
    size_t header_bytes;
    const struct raster_layout *layout;
    const unsigned char *pixels;
    bool is_upside_down, is_big_endian;
};

static bool write_rows(FILE *file, const struct plain_file *plain, unsigned char *row,
                       size_t row_bytes)
{
    const size_t sample = pixel_bytes(plain->layout->type);
    const bool swaps = plain->is_big_endian != machine_is_big_endian();
    for (uint64_t i = 0; i < plain->layout->rows; i++) {
        const uint64_t from = plain->is_upside_down ? plain->layout->rows - 1 - i : i;
        const unsigned char *pixels = plain->pixels + (size_t)from * row_bytes;
        for (size_t k = 0; k < row_bytes; k++)
            row[k] = pixels[swaps ? k / sample * sample + (sample - 1 - k % sample) : k];
        if (fwrite(row, 1, row_bytes, file) != row_bytes)
            return false;
    }
    return true;
}

static sonject_status write_plain(struct report *report, const struct plain_file *plain)
{
    const size_t row_bytes =
        (size_t)plain->layout->columns * plain->layout->channels * pixel_bytes(plain->layout->type);
    char *part = file_part_name(plain->path);
    unsigned char *row = allocate_array(row_bytes, 1);
    if (!part || !row) {
        free(part);
        free(row);
        return report_out_of_memory(report, "a row");
    }
    errno = 0;
    FILE *file = fopen(part, "wb");
    bool is_written = file &&
                      fwrite(plain->header, 1, plain->header_bytes, file) == plain->header_bytes &&
                      write_rows(file, plain, row, row_bytes);
    int error = errno;
    if (file && fclose(file) != 0 && is_written) {
        is_written = false;
        error = errno;
    }
    sonject_status status;
    if (is_written) {
        status = file_publish(report, part, plain->path);
    } else {
        status = file_failure(report, plain->path, "write", error ? error : EIO);
        file_discard(part);
    }
    free(part);
    free(row);
    return status;
}

static sonject_status write_npy(struct report *report, const char *path,
                                const struct raster_layout *layout, const void *pixels)
{
    char header[NPY_HEADER + 1];
    const char *type = layout->type == PIXEL_UINT8    ? "|u1"
                       : layout->type == PIXEL_UINT16 ? "<u2"
                       : layout->channels == 2        ? "<c8"
                                                      : "<f4";
    memset(header, ' ', sizeof header);
    memcpy(header, "\x93NUMPY\x01\x00\x76\x00", 10); /* 118 bytes follow */
    const int count =
        snprintf(header + 10, sizeof header - 10,
                 "{'descr': '%s', 'fortran_order': False, 'shape': (%llu, %llu), }", type,
                 (unsigned long long)layout->rows, (unsigned long long)layout->columns);
    header[10 + count] = ' ';
    header[NPY_HEADER - 1] = '\n';
    const struct plain_file plain = {path, header, NPY_HEADER, layout, pixels, false, false};
    return write_plain(report, &plain);
}

static sonject_status write_pnm(struct report *report, const char *path,
                                const struct raster_layout *layout,
                                const struct raster_attribute *attributes, size_t count,
                                const void *pixels)
{
    struct growing_text text = {0};
    const bool is_float = layout->type == PIXEL_FLOAT32;
    growing_text_add(&text, is_float ? "Pf\n" : "P5\n");
    for (size_t i = 0; !is_float && i < count; i++)
        growing_text_add(&text, "# %s=%s\n", attributes[i].name, attributes[i].value);
    growing_text_add(&text, "%llu %llu\n%s\n", (unsigned long long)layout->columns,
                     (unsigned long long)layout->rows,
                     is_float                      ? "-1.0"
                     : layout->type == PIXEL_UINT8 ? "255"
                                                   : "65535");
    char *header = growing_text_end(&text);
    sonject_status status = SONJECT_ERROR_MEMORY;
    if (header) {
        const struct plain_file plain = {path,   header,   strlen(header), layout,
                                         pixels, is_float, !is_float};
        status = write_plain(report, &plain);
    } else {
        status = report_out_of_memory(report, "a header");
    }
    free(header);
    return status;
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
    case FORMAT_PGM:
    case FORMAT_PFM:
        return write_pnm(report, path, layout, attributes, attribute_count, pixels);
    default:
        return raster_file_write(report, path, layout, layout->channels == 2 ? complex_names : NULL,
                                 attributes, attribute_count, pixels);
    }
}
