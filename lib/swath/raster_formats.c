#include "swath/raster_formats.h"

#include <string.h>

#include "swath/hdf5_array.h"

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

sonject_status raster_format_write(struct report *report, const char *path,
                                   const struct raster_layout *layout,
                                   const struct raster_attribute *attributes,
                                   size_t attribute_count, const void *pixels)
{
    static const char *const complex_names[] = {"real", "imag"};
    CHECK(raster_format_check(report, path, layout));
    switch (format_of(path)) {
    case FORMAT_NPY:
        return npy_write(report, path, layout->type, layout->channels == 2,
                         (const uint64_t[]){layout->rows, layout->columns}, 2, pixels);
    case FORMAT_HDF5:
        return hdf5_array_write(report, path, layout, attributes, attribute_count, pixels);
    default:
        return raster_file_write(report, path, layout, layout->channels == 2 ? complex_names : NULL,
                                 attributes, attribute_count, pixels);
    }
}
