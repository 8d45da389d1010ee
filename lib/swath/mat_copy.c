/* A copy of a MATLAB file in which an array has other numbers. */
#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/byte_file.h"
#include "base/byte_order.h"
#include "base/file.h"
#include "base/memory.h"
#include "swath/array_list.h"
#include "swath/mat_element.h"

#define SUBSYSTEM_PLACE 116 /* of the header: where further data of MATLAB's own objects begin */
#define LARGEST_INT16   32767.0

static double sample_at(enum pixel_type type, const void *pixels, size_t at)
{
    return type == PIXEL_UINT8    ? (double)((const uint8_t *)pixels)[at]
           : type == PIXEL_UINT16 ? (double)((const uint16_t *)pixels)[at]
                                  : (double)((const float *)pixels)[at];
}

/* Bytes of a part whose numbers have the variable's own type, with its tag. */
static uint64_t unpacked_bytes(const struct mat_file *file)
{
    const uint64_t count = file->layout.rows * file->layout.columns;
    const uint64_t data = count * mat_type_bytes(mat_type_of_class(file->variable.kind));
    return MAT_TAG + (data + 7) / 8 * 8;
}

/* The element with its numbers in the variable's own type, for free(); parts gets where they lie.
 */
static unsigned char *unpack(const struct mat_file *file, struct mat_part *parts, size_t *bytes)
{
    const uint32_t type = mat_type_of_class(file->variable.kind);
    const size_t size = mat_type_bytes(type);
    const size_t count = (size_t)(file->layout.rows * file->layout.columns);
    const uint64_t each = unpacked_bytes(file);
    const uint64_t total = file->parts[0].tag + each * file->layout.channels;
    if (total - MAT_TAG > UINT32_MAX || total > SIZE_MAX)
        return NULL;
    unsigned char *element = allocate_array((size_t)total, 1);
    if (!element)
        return NULL;
    memcpy(element, file->element, file->parts[0].tag);
    number_to_bytes(total - MAT_TAG, element + 4, 4, file->is_big_endian);
    for (uint32_t k = 0; k < file->layout.channels; k++) {
        const struct mat_part *old = &file->parts[k];
        struct mat_part *part = &parts[k];
        part->type = type;
        part->tag = file->parts[0].tag + (size_t)each * k;
        part->data = part->tag + MAT_TAG;
        part->bytes = count * size;
        number_to_bytes(type, element + part->tag, 4, file->is_big_endian);
        number_to_bytes(part->bytes, element + part->tag + 4, 4, file->is_big_endian);
        for (size_t i = 0; i < count; i++)
            mat_set_number(element + part->data + i * size, type, file->is_big_endian,
                           mat_number(file->element + old->data + i * mat_type_bytes(old->type),
                                      old->type, file->is_big_endian));
    }
    *bytes = (size_t)total;
    return element;
}

static bool is_packed(const struct mat_file *file)
{
    bool packed = false;
    for (uint32_t k = 0; k < file->layout.channels; k++)
        packed |= file->parts[k].type != mat_type_of_class(file->variable.kind);
    return packed;
}

static sonject_status put_samples(struct report *report, const struct mat_file *file,
                                  const struct mat_part *parts, const struct region *region,
                                  const void *pixels, unsigned char *element)
{
    const struct raster_layout *layout = &file->layout;
    for (uint64_t i = 0; i < region->rows * region->columns; i++) {
        const uint64_t row = region->first_row + i / region->columns;
        const uint64_t column = region->first_column + i % region->columns;
        const size_t index = (size_t)(column * layout->rows + row);
        for (uint32_t k = 0; k < layout->channels; k++) {
            const uint32_t type = parts[k].type;
            unsigned char *at = element + parts[k].data + index * mat_type_bytes(type);
            double sample = sample_at(layout->type, pixels, (size_t)i * layout->channels + k);
            if (type == MAT_INT16 && sample > LARGEST_INT16)
                return report_failure(report, SONJECT_ERROR_INPUT,
                                      "%s: the sample at row %llu, column %llu is %g, more than "
                                      "the file's largest number of 32767",
                                      file->path, (unsigned long long)row,
                                      (unsigned long long)column, sample);
            if (type == MAT_DOUBLE)
                sample = kept_or_new(mat_number(at, type, file->is_big_endian), (float)sample);
            mat_set_number(at, type, file->is_big_endian, sample);
        }
    }
    return SONJECT_OK;
}

/* The variable's element as the copy shall have it, for free(). */
static sonject_status make_element(struct report *report, const struct mat_file *file,
                                   const struct region *region, const void *pixels,
                                   unsigned char **element, size_t *bytes)
{
    struct mat_part parts[2] = {file->parts[0], file->parts[1]};
    *bytes = file->element_bytes;
    if (is_packed(file)) {
        *element = unpack(file, parts, bytes);
    } else {
        *element = allocate_array(*bytes, 1);
        if (*element)
            memcpy(*element, file->element, *bytes);
    }
    if (!*element)
        return report_out_of_memory(report, "an array");
    const sonject_status status = put_samples(report, file, parts, region, pixels, *element);
    if (status != SONJECT_OK || !file->variable.is_compressed)
        return status;
    size_t compressed_bytes = 0;
    unsigned char *compressed = mat_deflate(*element, *bytes, &compressed_bytes);
    unsigned char *tagged = compressed && compressed_bytes <= UINT32_MAX
                                ? allocate_array(compressed_bytes + MAT_TAG, 1)
                                : NULL;
    if (tagged) {
        number_to_bytes(MAT_COMPRESSED, tagged, 4, file->is_big_endian);
        number_to_bytes(compressed_bytes, tagged + 4, 4, file->is_big_endian);
        memcpy(tagged + MAT_TAG, compressed, compressed_bytes);
        free(*element);
        *element = tagged;
        *bytes = compressed_bytes + MAT_TAG;
    }
    free(compressed);
    return tagged ? SONJECT_OK : report_out_of_memory(report, "a compressed array");
}

/* The header names the place of MATLAB's own data, which moves with the variable's size. */
static bool move_subsystem(const struct mat_file *file, FILE *out, uint64_t bytes)
{
    unsigned char word[8];
    const uint64_t end = file->variable.place + file->variable.bytes;
    if (!byte_file_read(file->file, SUBSYSTEM_PLACE, word, sizeof word))
        return false;
    const uint64_t place = number_from_bytes(word, 8, file->is_big_endian);
    if (place < end || place >= file->file_bytes || bytes == file->variable.bytes)
        return true;
    number_to_bytes(place - file->variable.bytes + bytes, word, 8, file->is_big_endian);
    return fseeko(out, SUBSYSTEM_PLACE, SEEK_SET) == 0 &&
           fwrite(word, 1, sizeof word, out) == sizeof word;
}

static sonject_status write_copy(struct report *report, const struct mat_file *file,
                                 const char *path, FILE *out, const unsigned char *element,
                                 size_t bytes)
{
    const struct mat_variable *variable = &file->variable;
    const uint64_t end = variable->place + variable->bytes;
    errno = 0;
    if (byte_file_copy(file->file, 0, variable->place, out) &&
        fwrite(element, 1, bytes, out) == bytes &&
        byte_file_copy(file->file, end, file->file_bytes - end, out) &&
        move_subsystem(file, out, bytes))
        return SONJECT_OK;
    return ferror(out) ? file_failure(report, path, "write", errno)
                       : report_failure(report, SONJECT_ERROR_INPUT,
                                        "%s: cannot be read to its end", file->path);
}

static sonject_status write_part(struct report *report, const struct mat_file *file,
                                 const char *path, const char *part, const unsigned char *element,
                                 size_t bytes)
{
    FILE *out = fopen(part, "w+b");
    if (!out)
        return file_failure(report, path, "write", errno);
    sonject_status status = write_copy(report, file, path, out, element, bytes);
    if (fclose(out) != 0 && status == SONJECT_OK)
        status = file_failure(report, path, "write", errno);
    if (status == SONJECT_OK)
        return file_publish(report, part, path);
    file_discard(part);
    return status;
}

sonject_status mat_file_copy_with_patch(struct report *report, const struct mat_file *file,
                                        const char *path, const struct region *region,
                                        const void *pixels, sonject_progress_function progress,
                                        void *user)
{
    unsigned char *element = NULL;
    size_t bytes = 0;
    if (!region_is_inside(&file->layout, region))
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: the region is not inside the image",
                              file->path);
    if (progress && progress(user, 0.0, "write") != 0)
        return report_failure(report, SONJECT_CANCELLED, "cancelled");
    sonject_status status = make_element(report, file, region, pixels, &element, &bytes);
    char *part = status == SONJECT_OK ? file_part_name(path) : NULL;
    if (status == SONJECT_OK)
        status = part ? write_part(report, file, path, part, element, bytes)
                      : report_out_of_memory(report, "a file name");
    free(part);
    free(element);
    return status;
}
