#include "swath/swath_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "swath/swath_format.h"

#define COPIED_AT_ONCE ((uint64_t)8 << 20)
#define PIXELS_MAX     ((uint64_t)1 << 31) /* limit of swath_file_read_all */

#define FORMAT_ADDRESS(name, files) &name##_format,
static const struct swath_format *const formats[] = {SWATH_FORMATS(FORMAT_ADDRESS)};

void swath_file_close(struct swath_file **file)
{
    if (!file || !*file)
        return;
    if ((*file)->stream)
        fclose((*file)->stream);
    free((*file)->lines.places);
    free((*file)->lines.scales);
    free((*file)->recording.pings);
    free((*file)->recording.empty.numbers);
    mat_array_release(&(*file)->mat);
    decoded_image_close(&(*file)->decoded);
    free((*file)->path);
    free(*file);
    *file = NULL;
}

static sonject_status recognise(struct report *report, const char *path, struct swath_file **opened)
{
    unsigned char head[16] = {0};
    struct swath_file *file = *opened = allocate_array(1, sizeof *file);
    CHECK_MEMORY(report, file && (file->path = copy_text(path)), "a file");
    file->stream = byte_file_open(path, &file->bytes);
    if (!file->stream)
        return file_refuse(report, path, errno);
    const size_t count = fread(head, 1, sizeof head, file->stream);
    if (ferror(file->stream))
        return file_failure(report, path, "read", errno);
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (formats[i]->is_of(file, head, count)) {
            file->format = formats[i];
            return SONJECT_OK;
        }
    return image_kind_refuse(report, path, head, count);
}

static sonject_status open_recognised(struct report *report, struct swath_file *file,
                                      const struct swath_format *beside, int32_t channel,
                                      const char *array)
{
    const struct swath_format *format = file->format;
    if (!format->has_channels && beside && beside->has_channels)
        channel = SONJECT_CHANNEL_ONLY;
    if (!format->has_names && beside && beside->has_names)
        array = NULL;
    if (channel != SONJECT_CHANNEL_ONLY && !format->has_channels)
        return input_failure(report, file->path,
                             "is neither XTF nor JSF, so it has no channels: take the channel out");
    if (array && !format->has_names)
        return input_failure(
            report, file->path,
            "is neither HDF5 nor MATLAB, so its arrays have no names: take the array out");
    return format->open(report, file, channel, array);
}

/* Returns NULL for a file that cannot be read. Opening the file reports why. */
static const struct swath_format *format_of(const char *path)
{
    struct report unheard = {.host = NULL};
    struct swath_file *file = NULL;
    const struct swath_format *format =
        path && recognise(&unheard, path, &file) == SONJECT_OK ? file->format : NULL;
    swath_file_close(&file);
    return format;
}

bool swath_file_has_channels(const char *path)
{
    const struct swath_format *format = format_of(path);
    return format && format->has_channels;
}

sonject_status swath_file_open_beside(struct report *report, const char *path, const char *other,
                                      int32_t channel, const char *array, struct swath_file **file)
{
    errno = 0;
    sonject_status status = file_check_disk(report, path, recognise(report, path, file));
    const struct swath_format *beside = status == SONJECT_OK ? format_of(other) : NULL;
    errno = 0;
    THEN(status,
         file_check_disk(report, path, open_recognised(report, *file, beside, channel, array)));
    if (status != SONJECT_OK)
        swath_file_close(file);
    return status;
}

sonject_status swath_file_open_array(struct report *report, const char *path, int32_t channel,
                                     const char *array, struct swath_file **file)
{
    return swath_file_open_beside(report, path, NULL, channel, array, file);
}

void swath_file_layout(const struct swath_file *file, struct raster_layout *layout)
{
    *layout = file->layout;
}

const char *swath_file_new_extension(const struct swath_file *file)
{
    return file->format == &image_format && file->image != IMAGE_TIFF ? ".png" : NULL;
}

int swath_file_jpeg_quality(const struct swath_file *file)
{
    return file->decoded ? file->decoded->jpeg_quality : 0;
}

uint32_t swath_file_largest(const struct swath_file *file)
{
    return file->largest;
}

double swath_file_full_scale(const struct swath_file *file)
{
    return file->largest > 0 ? (double)file->largest : pixel_full_scale(file->layout.type);
}

void swath_file_refuse_rounding(struct swath_file *file)
{
    file->lines.is_exact = true;
}

void swath_file_limit(const struct swath_file *file, sonject_transfer_params *transfer)
{
    const double largest = (double)file->largest;
    if (largest > 0.0 && !(transfer->full_scale > 0.0 && transfer->full_scale < largest))
        transfer->full_scale = largest;
}

enum range_axis swath_file_range_axis(const struct swath_file *file)
{
    char axis[16] = "";
    if (swath_file_recording(file))
        return file->recording.is_ground_range ? RANGE_GROUND : RANGE_SLANT;
    if (!swath_file_attribute(file, "sonject:range_axis", axis, sizeof axis))
        return RANGE_UNKNOWN;
    return strcmp(axis, "ground") == 0  ? RANGE_GROUND
           : strcmp(axis, "slant") == 0 ? RANGE_SLANT
                                        : RANGE_UNKNOWN;
}

const struct recording *swath_file_recording(const struct swath_file *file)
{
    return file->format->has_channels ? &file->recording : NULL;
}

bool swath_file_attribute(const struct swath_file *file, const char *name, char *value,
                          size_t capacity)
{
    const size_t length = strlen(name);
    const char *line = file->decoded ? file->decoded->description : NULL;
    for (; line; line = strchr(line, '\n'), line = line ? line + 1 : NULL) {
        if (strncmp(line, name, length) != 0 || line[length] != '=')
            continue;
        const char *text = line + length + 1;
        const size_t count = strcspn(text, "\n");
        if (count < capacity) {
            memcpy(value, text, count);
            value[count] = '\0';
        }
        return count < capacity;
    }
    return false;
}

static sonject_status check_region(struct report *report, const struct swath_file *file,
                                   const struct region *region)
{
    return region_is_inside(&file->layout, region)
               ? SONJECT_OK
               : input_failure(report, file->path, "the region is not inside the image");
}

sonject_status swath_file_read(struct report *report, struct swath_file *file,
                               const struct region *region, void *pixels)
{
    CHECK(check_region(report, file, region));
    errno = 0;
    return file_check_disk(report, file->path, file->format->read(report, file, region, pixels));
}

sonject_status swath_file_read_all(struct report *report, struct swath_file *file,
                                   struct raster_layout *layout, void **pixels)
{
    size_t bytes = 0;
    *pixels = NULL;
    swath_file_layout(file, layout);
    const struct region whole = {0, 0, layout->rows, layout->columns};
    if (layout->rows > PIXELS_MAX / layout->columns || !region_bytes(layout, &whole, &bytes))
        return input_failure(report, file->path,
                             "%llu x %llu pixels are more than the 2^31 that are read at once",
                             (unsigned long long)layout->rows, (unsigned long long)layout->columns);
    *pixels = allocate_array(bytes, 1);
    CHECK_MEMORY(report, *pixels, file->path);
    const sonject_status status = swath_file_read(report, file, &whole, *pixels);
    if (status != SONJECT_OK) {
        free(*pixels);
        *pixels = NULL;
    }
    return status;
}

sonject_status swath_file_copy_with_patch(struct report *report, const struct swath_file *file,
                                          const char *path, const struct region *region,
                                          const void *pixels, sonject_progress_function progress,
                                          void *user)
{
    CHECK(check_region(report, file, region));
    char *part = file_part_name(path);
    CHECK_MEMORY(report, part, "a file name");
    const struct swath_copy copy = {path, part, region, pixels, progress, user};
    errno = 0;
    sonject_status status =
        file_check_disk(report, file->path, file->format->copy(report, file, &copy));
    if (status == SONJECT_OK)
        status = file_publish(report, part, path);
    else
        file_discard(part);
    free(part);
    return status;
}

sonject_status swath_copy_bytes(struct report *report, const struct swath_file *file,
                                const struct swath_copy *copy, uint64_t first, uint64_t end,
                                FILE *out)
{
    for (uint64_t place = first; place < end; place += COPIED_AT_ONCE) {
        const uint64_t some = end - place < COPIED_AT_ONCE ? end - place : COPIED_AT_ONCE;
        errno = 0;
        if (!byte_file_copy(file->stream, place, some, out))
            return ferror(out) ? file_failure(report, copy->path, "write", errno)
                               : input_failure(report, file->path, "is cut short: copy it again");
        if (copy->progress &&
            copy->progress(copy->user, (double)place / (double)file->bytes, "write") != 0)
            return report_failure(report, SONJECT_CANCELLED, "cancelled");
    }
    return SONJECT_OK;
}

sonject_status swath_close_copy(struct report *report, const struct swath_copy *copy, FILE *out,
                                sonject_status status)
{
    if (out && fclose(out) != 0)
        THEN(status, file_failure(report, copy->path, "write", errno));
    return status;
}

static void tell_clipped(struct report *report, const char *path, uint64_t count)
{
    report_note(report,
                "%s cannot hold %llu of the changed numbers, which are beyond their pings' "
                "samples: they are clipped",
                path, (unsigned long long)count);
}

/* Reads a region's lines one at a time, or writes them to a copy if out is not NULL. */
static sonject_status exchange_lines(struct report *report, const struct swath_file *file,
                                     const struct region *region, void *pixels,
                                     const struct swath_copy *copy, FILE *out)
{
    const struct sample_lines *lines = &file->lines;
    const bool turned = lines->is_transposed;
    const size_t sample = stored_bytes(lines->type);
    const size_t pixel = file->layout.channels * sample;
    const uint64_t count = turned ? region->columns : region->rows;
    const size_t bytes = (size_t)(turned ? region->rows : region->columns) * pixel;
    const uint64_t before = turned ? region->first_row
                            : lines->is_reversed
                                ? file->layout.columns - region->first_column - region->columns
                                : region->first_column;
    uint64_t clipped = 0;
    unsigned char *line = allocate_array(bytes, 1);
    const ptrdiff_t step = (ptrdiff_t)file->layout.channels;
    unsigned char *first = lines->is_reversed && line ? line + bytes - pixel : line;
    struct stored_samples stored = {
        .bytes = {first, line ? first + sample : NULL},
        .types = {lines->type, lines->type},
        .row_step = step,
        .column_step = lines->is_reversed ? -step : step,
        .is_big_endian = lines->is_big_endian,
        .are_amplitudes = file->layout.channels == 1,
        .clips = lines->clips,
        .clipped = &clipped,
        .is_exact = lines->is_exact,
        .largest = lines->scales ? 0 : file->largest,
    };
    sonject_status status = line ? SONJECT_OK : report_out_of_memory(report, "a row");
    for (uint64_t i = 0; status == SONJECT_OK && i < count; i++) {
        const uint64_t number = i + (turned ? region->first_column : region->first_row);
        const uint64_t place =
            before * pixel + (lines->places ? lines->places[number]
                                            : lines->first_place + number * lines->line_bytes);
        const struct region part = {region->first_row + (turned ? 0 : i),
                                    region->first_column + (turned ? i : 0),
                                    turned ? region->rows : 1, turned ? 1 : region->columns};
        stored.scale = lines->scales ? lines->scales[number] : 1.0;
        if (!byte_file_read(file->stream, place, line, bytes))
            status = input_failure(report, file->path, "is cut short: copy it again");
        else
            status = samples_exchange(report, file->path, &file->layout, &stored, &part, region,
                                      pixels, out != NULL);
        if (status == SONJECT_OK && out &&
            (!byte_file_seek(out, place) || fwrite(line, 1, bytes, out) != bytes))
            status = file_failure(report, copy->path, "write", errno);
    }
    free(line);
    if (status == SONJECT_OK && clipped > 0)
        tell_clipped(report, copy->path, clipped);
    return status;
}

sonject_status sample_lines_read(struct report *report, struct swath_file *file,
                                 const struct region *region, void *pixels)
{
    return exchange_lines(report, file, region, pixels, NULL, NULL);
}

sonject_status sample_lines_copy(struct report *report, const struct swath_file *file,
                                 const struct swath_copy *copy)
{
    FILE *out = file_open(copy->part, "w+b");
    if (!out)
        return file_failure(report, copy->path, "write", errno);
    sonject_status status = swath_copy_bytes(report, file, copy, 0, file->bytes, out);
    THEN(status, exchange_lines(report, file, copy->region, (void *)copy->pixels, copy, out));
    return swath_close_copy(report, copy, out, status);
}
