#include "swath/raster_file.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "swath/image_library.h"
#include "swath/swath_format.h"

#define PIXELS_MAX    ((uint64_t)1 << 40)
#define PNG_SIDE_MAX  1000000 /* limit of libpng */
#define JPEG_SIDE_MAX 65500   /* limit of libjpeg */

/* The rows of an image that is written: source's, or zeros, with the region's pixels put in. */
struct patched_rows {
    struct report *report;
    struct decoded_image *source; /* NULL: zeros */
    struct raster_layout layout;
    const struct region *region;
    const void *pixels;
    sonject_progress_function progress; /* may be NULL */
    void *user;
    int quality; /* JPEG's; 0: the finest */
};

struct raster_attribute raster_make_grey(struct report *report, struct raster_layout *layout,
                                         void *pixels, double full_scale, const double ends_db[2],
                                         char text[GREY_TEXT])
{
    const size_t count = (size_t)layout->rows * (size_t)layout->columns;
    unsigned char *grey = pixels;
    size_t white = 0, black = 0;
    for (size_t i = 0; i < count; i++) {
        const double amplitude = pixel_magnitude(layout, pixels, i) / full_scale;
        const double level = 20.0 * log10(fmax(amplitude, 1e-300));
        const double share = (level - ends_db[0]) / (ends_db[1] - ends_db[0]);
        grey[i] = (unsigned char)(255.0 * fmin(fmax(share, 0.0), 1.0) + 0.5);
        white += share >= 1.0;
        black += share <= 0.0;
    }
    if (report && (2 * white > count || 2 * black > count))
        report_note(report,
                    "%.0f %% of the pixels are %s at grey levels of %g to %g dB: levels are over "
                    "full scale, %g here; sonject quicklook shows which suit",
                    100.0 * (double)(white > black ? white : black) / (double)count,
                    white > black ? "white" : "black", ends_db[0], ends_db[1], full_scale);
    layout->channels = 1;
    layout->type = PIXEL_UINT8;
    char ends[2][24];
    snprintf(text, GREY_TEXT, "%s dB, %s dB",
             text_of_number(ends[0], sizeof ends[0], ends_db[0], 6),
             text_of_number(ends[1], sizeof ends[1], ends_db[1], 6));
    return (struct raster_attribute){GREY_ATTRIBUTE, text};
}

static sonject_status give_rows(void *user, uint64_t first, uint64_t end, void *pixels)
{
    const struct patched_rows *rows = user;
    const struct region *region = rows->region;
    const size_t pixel = rows->layout.channels * pixel_bytes(rows->layout.type);
    const size_t row_bytes = (size_t)rows->layout.columns * pixel;
    const size_t patch_bytes = (size_t)region->columns * pixel;
    const struct region strip = {first, 0, end - first, rows->layout.columns};
    const uint64_t region_end = region->first_row + region->rows;
    if (rows->source)
        CHECK(decoded_image_read(rows->report, rows->source, &strip, pixels));
    else
        memset(pixels, 0, (size_t)(end - first) * row_bytes);
    for (uint64_t row = first > region->first_row ? first : region->first_row;
         row < end && row < region_end; row++)
        memcpy((unsigned char *)pixels + (size_t)(row - first) * row_bytes +
                   (size_t)region->first_column * pixel,
               (const unsigned char *)rows->pixels +
                   (size_t)(row - region->first_row) * patch_bytes,
               patch_bytes);
    if (rows->progress &&
        rows->progress(rows->user, (double)end / (double)rows->layout.rows, "write") != 0)
        return report_failure(rows->report, SONJECT_CANCELLED, "cancelled");
    return SONJECT_OK;
}

static sonject_status encode(struct patched_rows *rows, const char *part, const char *name,
                             enum image_kind kind, const char *description, bool is_drawn,
                             const uint8_t *palette)
{
    const struct image_encoding encoding = {part,        name,         kind,    rows->layout,
                                            description, is_drawn,     palette, give_rows,
                                            rows,        rows->quality};
    return kind == IMAGE_TIFF  ? tiff_encode(rows->report, &encoding)
           : kind == IMAGE_PNG ? png_encode(rows->report, &encoding)
                               : jpeg_encode(rows->report, &encoding);
}

sonject_status raster_file_copy_with_patch(struct report *report, struct decoded_image *source,
                                           const struct swath_copy *copy)
{
    struct patched_rows rows = {report,       source,         source->layout, copy->region,
                                copy->pixels, copy->progress, copy->user,     0};
    return encode(&rows, copy->part, copy->path, IMAGE_PNG, source->description, false, NULL);
}

static sonject_status write_npy(struct report *report, const char *path,
                                const struct raster_layout *layout,
                                const struct raster_attribute *attributes, size_t attribute_count,
                                const void *pixels)
{
    (void)attributes, (void)attribute_count;
    return npy_write(report, path, layout->type, layout->channels == 2,
                     (const uint64_t[]){layout->rows, layout->columns}, 2, pixels);
}

#ifndef HAS_HDF5
sonject_status hdf5_array_write(struct report *report, const char *path,
                                const struct raster_layout *layout,
                                const struct raster_attribute *notes, size_t note_count,
                                const void *pixels)
{
    (void)layout, (void)notes, (void)note_count, (void)pixels;
    return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                          "%s: this build of sonject writes no HDF5: write .tif or .npy", path);
}
#endif

/* Formats of new files by extension, in upper or lower case. */
static const struct new_format {
    const char *extension;
    enum image_kind kind; /* the image's, if write is NULL */
    sonject_status (*write)(struct report *report, const char *path,
                            const struct raster_layout *layout,
                            const struct raster_attribute *attributes, size_t attribute_count,
                            const void *pixels);
} new_formats[] = {{".tif", IMAGE_TIFF, NULL},
                   {".tiff", IMAGE_TIFF, NULL},
                   {".png", IMAGE_PNG, NULL},
                   {".jpg", IMAGE_JPEG, NULL},
                   {".jpeg", IMAGE_JPEG, NULL},
                   {".npy", IMAGE_TIFF, write_npy},
                   {".h5", IMAGE_TIFF, hdf5_array_write},
                   {".hdf5", IMAGE_TIFF, hdf5_array_write}};

/* Returns NULL for an unknown extension. */
static const struct new_format *format_of(const char *path)
{
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < sizeof new_formats / sizeof *new_formats; i++)
        if (strlen(dot) == strlen(new_formats[i].extension) &&
            contains_ignoring_case(dot, new_formats[i].extension))
            return &new_formats[i];
    return NULL;
}

static sonject_status kind_to_write(struct report *report, const char *path,
                                    const struct raster_layout *layout, enum image_kind *kind)
{
    const struct new_format *format = format_of(path);
    if (!format || format->write)
        return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                              "%s: images are written as .tif, .png or .jpg: choose one of these "
                              "extensions",
                              path);
    *kind = format->kind;
    if ((*kind == IMAGE_PNG && layout->type == PIXEL_FLOAT32) ||
        (*kind == IMAGE_JPEG && layout->type != PIXEL_UINT8))
        return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                              "%s: this format does not hold %s pixels: write .tif", path,
                              layout->type == PIXEL_FLOAT32 ? "floating-point" : "16-bit");
    const bool is_grey_or_colour = layout->channels == 1 || layout->channels == 3;
    if (!is_grey_or_colour && (*kind != IMAGE_TIFF || layout->channels != 2))
        return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                              "%s: this format does not hold %u channels: write .tif with 1 to 3",
                              path, layout->channels);
    const uint64_t side_max = *kind == IMAGE_PNG    ? PNG_SIDE_MAX
                              : *kind == IMAGE_JPEG ? JPEG_SIDE_MAX
                                                    : INT_MAX;
    if (layout->rows == 0 || layout->columns == 0 || layout->rows > side_max ||
        layout->columns > side_max || layout->rows > PIXELS_MAX / layout->columns)
        return report_failure(
            report, SONJECT_ERROR_UNSUPPORTED, "%s: %llu x %llu pixels cannot be written", path,
            (unsigned long long)layout->rows, (unsigned long long)layout->columns);
    return SONJECT_OK;
}

static sonject_status write_rows(struct patched_rows *rows, const char *path,
                                 const char *description, bool is_drawn, const uint8_t *palette)
{
    enum image_kind kind = IMAGE_TIFF;
    CHECK(kind_to_write(rows->report, path, &rows->layout, &kind));
    char *part = file_part_name(path);
    CHECK_MEMORY(rows->report, part, "a file name");
    sonject_status status = encode(rows, part, path, kind, description, is_drawn, palette);
    THEN(status, file_publish(rows->report, part, path));
    file_discard(part);
    free(part);
    return status;
}

static sonject_status write_raster(struct report *report, const char *path,
                                   const struct raster_layout *layout,
                                   const char *const *channel_names,
                                   const struct raster_attribute *attributes,
                                   size_t attribute_count, const void *pixels, int quality)
{
    const struct region whole = {0, 0, layout->rows, layout->columns};
    struct patched_rows rows = {report, NULL, *layout, &whole, pixels, NULL, NULL, quality};
    struct growing_text text = {0};
    for (uint32_t i = 0; channel_names && i < layout->channels; i++)
        growing_text_add(&text, "%s%s", i == 0 ? "channels=" : ",", channel_names[i]);
    for (size_t i = 0; i < attribute_count; i++)
        growing_text_add(&text, "%s%s=%s", text.length > 0 ? "\n" : "", attributes[i].name,
                         attributes[i].value);
    char *description = growing_text_end(&text);
    CHECK_MEMORY(report, description, "a description");
    const sonject_status status = write_rows(&rows, path, description, layout->channels == 3, NULL);
    free(description);
    return status;
}

sonject_status raster_file_write(struct report *report, const char *path,
                                 const struct raster_layout *layout,
                                 const char *const *channel_names,
                                 const struct raster_attribute *attributes, size_t attribute_count,
                                 const void *pixels)
{
    return write_raster(report, path, layout, channel_names, attributes, attribute_count, pixels,
                        0);
}

sonject_status raster_file_write_jpeg(struct report *report, const char *path,
                                      const struct raster_layout *layout,
                                      const struct raster_attribute *attributes,
                                      size_t attribute_count, const void *pixels, int quality)
{
    return write_raster(report, path, layout, NULL, attributes, attribute_count, pixels, quality);
}

sonject_status picture_write(struct report *report, sonject_status status, struct canvas *picture,
                             const char *path)
{
    const struct raster_layout layout = {picture->height, picture->width, 3, PIXEL_UINT8};
    THEN(status, raster_file_write(report, path, &layout, NULL, NULL, 0, picture->rgb));
    free(picture->rgb);
    return status;
}

sonject_status raster_file_write_placed(struct report *report, const char *path,
                                        const struct raster_layout *layout,
                                        const struct region *region, const void *pixels,
                                        const uint8_t *palette)
{
    struct patched_rows rows = {report, NULL, *layout, region, pixels, NULL, NULL, 0};
    return region_is_inside(layout, region)
               ? write_rows(&rows, path, "", true, palette)
               : report_failure(report, SONJECT_ERROR_STORAGE,
                                "%s: the region is not inside the image", path);
}

bool raster_format_keeps_attributes(const char *path)
{
    const struct new_format *format = format_of(path);
    return !format || format->write != write_npy;
}

/* Checks that the extension names a lossless format for such samples. */
static sonject_status check_format(struct report *report, const char *path,
                                   const struct raster_layout *layout)
{
    const struct new_format *format = format_of(path);
    const bool is_float = layout->type == PIXEL_FLOAT32;
    if (!format || format->kind == IMAGE_JPEG)
        return input_failure(report, path,
                             "images are written without loss as .tif, .png, .npy or .h5: choose "
                             "one of these extensions");
    if (format->kind == IMAGE_PNG ? layout->channels == 1 && !is_float
                                  : layout->channels == 1 || is_float)
        return SONJECT_OK;
    return input_failure(report, path,
                         "this format does not hold %s samples: write .tif, .npy or .h5",
                         layout->channels == 2 ? "complex"
                         : is_float            ? "floating-point"
                                               : "integer");
}

sonject_status raster_format_write(struct report *report, const char *path,
                                   const struct raster_layout *layout,
                                   const struct raster_attribute *attributes,
                                   size_t attribute_count, const void *pixels)
{
    static const char *const complex_names[] = {"real", "imag"};
    CHECK(check_format(report, path, layout));
    const struct new_format *format = format_of(path);
    return format->write ? format->write(report, path, layout, attributes, attribute_count, pixels)
                         : raster_file_write(report, path, layout,
                                             layout->channels == 2 ? complex_names : NULL,
                                             attributes, attribute_count, pixels);
}

/* ---- Functions that the writers of image files share. */

sonject_status encode_rows(struct report *report, const struct image_encoding *encoding,
                           bool (*put)(void *output, const unsigned char *rows, uint64_t count),
                           void *output, bool *are_put)
{
    const struct raster_layout *layout = &encoding->layout;
    const uint64_t at_once = rows_at_once(layout);
    sonject_status status = SONJECT_OK;
    unsigned char *strip = allocate_array(
        (size_t)at_once, (size_t)layout->columns * layout->channels * pixel_bytes(layout->type));
    CHECK_MEMORY(report, strip, encoding->name);
    *are_put = true;
    for (uint64_t first = 0; status == SONJECT_OK && *are_put && first < layout->rows;
         first += at_once) {
        const uint64_t end = layout->rows - first < at_once ? layout->rows : first + at_once;
        status = encoding->give_rows(encoding->user, first, end, strip);
        if (status == SONJECT_OK)
            *are_put = put(output, strip, end - first);
    }
    free(strip);
    return status;
}

sonject_status encoding_failure(struct report *report, const struct image_encoding *encoding,
                                const struct library_fault *fault)
{
    if (fault->error == ENOMEM)
        return report_out_of_memory(report, encoding->name);
    return fault->error != 0 ? file_failure(report, encoding->name, "write", fault->error)
                             : report_failure(report, SONJECT_ERROR_STORAGE, "%s: cannot write: %s",
                                              encoding->name, fault->message);
}

sonject_status encoding_end(struct report *report, const struct image_encoding *encoding,
                            FILE *file, struct library_fault *fault, bool is_written,
                            sonject_status status)
{
    if (file && fclose(file) != 0 && is_written) {
        is_written = false;
        fault->error = errno;
    }
    return status != SONJECT_OK || is_written ? status : encoding_failure(report, encoding, fault);
}
