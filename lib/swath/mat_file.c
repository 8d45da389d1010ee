#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64
#include "swath/mat_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/byte_file.h"
#include "base/byte_order.h"
#include "base/file.h"
#include "base/memory.h"
#include "swath/array_list.h"
#include "swath/mat_element.h"

#define HEADER_BYTES  128
#define HEAD_BYTES    512  /* that hold class, sides and name of a variable */
#define DEFLATE_RATIO 1040 /* more than any deflated byte holds */

bool mat_begins(const unsigned char *bytes, size_t count)
{
    static const char mark[] = "MATLAB 5";
    return count >= sizeof mark - 1 && memcmp(bytes, mark, sizeof mark - 1) == 0;
}

static sonject_status damaged(struct report *report, const struct mat_file *file, uint64_t place)
{
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: cut short or damaged at byte %llu: copy or export it again",
                          file->path, (unsigned long long)place);
}

/* Finds out what a variable is; a compressed one's beginning is inflated. */
static sonject_status look_at(struct report *report, const struct mat_file *file,
                              struct mat_variable *variable)
{
    unsigned char stored[HEAD_BYTES];
    unsigned char head[HEAD_BYTES];
    const uint64_t from = variable->place + (variable->is_compressed ? MAT_TAG : 0);
    const uint64_t there = variable->place + variable->bytes - from;
    size_t count = there < HEAD_BYTES ? (size_t)there : HEAD_BYTES;
    if (!byte_file_read(file->file, from, stored, count))
        return damaged(report, file, from);
    if (!variable->is_compressed) {
        mat_read_head(stored, count, file->is_big_endian, variable);
        return SONJECT_OK;
    }
    if (!mat_can_inflate())
        return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                              "%s: is compressed, which this build of sonject does not read: build "
                              "it with zlib, or save the file with -v6",
                              file->path);
    if (!mat_inflate(stored, count, head, sizeof head, &count))
        return damaged(report, file, from);
    mat_read_head(head, count, file->is_big_endian, variable);
    return SONJECT_OK;
}

/* Walks through the file's variables and keeps the one that is wanted. */
static sonject_status choose_variable(struct report *report, struct mat_file *file,
                                      const char *array)
{
    struct array_list list = {array, 0, 0, ""};
    unsigned char tag[MAT_TAG];
    for (uint64_t place = HEADER_BYTES; place < file->file_bytes;) {
        struct mat_variable variable;
        memset(&variable, 0, sizeof variable);
        if (file->file_bytes - place < MAT_TAG ||
            !byte_file_read(file->file, place, tag, sizeof tag))
            return damaged(report, file, place);
        const uint64_t type = number_from_bytes(tag, 4, file->is_big_endian);
        variable.place = place;
        variable.bytes = MAT_TAG + number_from_bytes(tag + 4, 4, file->is_big_endian);
        variable.is_compressed = type == MAT_COMPRESSED;
        if ((type != MAT_COMPRESSED && type != MAT_MATRIX) ||
            variable.bytes > file->file_bytes - place)
            return damaged(report, file, place);
        const sonject_status status = look_at(report, file, &variable);
        if (status != SONJECT_OK)
            return status;
        const bool is_read = mat_type_of_class(variable.kind) != 0 &&
                             (!variable.is_complex || variable.kind <= MAT_CLASS_SINGLE);
        if (variable.head > 0 &&
            array_list_add(&list, variable.name, variable.rows, variable.columns,
                           is_read && variable.rows > 1 && variable.columns > 1))
            file->variable = variable;
        place += variable.bytes;
    }
    return array_list_check(report, file->path, &list);
}

/* Inflates the whole variable. What it says of its size is believed no further than compressed
 * bytes can hold. */
static sonject_status inflate_element(struct report *report, struct mat_file *file,
                                      const unsigned char *stored, size_t count)
{
    unsigned char tag[MAT_TAG];
    size_t got = 0;
    if (!mat_inflate(stored, count, tag, sizeof tag, &got) || got != sizeof tag)
        return damaged(report, file, file->variable.place);
    const uint64_t bytes = MAT_TAG + number_from_bytes(tag + 4, 4, file->is_big_endian);
    if (bytes / DEFLATE_RATIO > count || bytes > SIZE_MAX)
        return damaged(report, file, file->variable.place);
    file->element_bytes = (size_t)bytes;
    file->element = allocate_array(file->element_bytes, 1);
    if (!file->element)
        return report_out_of_memory(report, "an array");
    if (!mat_inflate(stored, count, file->element, file->element_bytes, &got) ||
        got != file->element_bytes)
        return damaged(report, file, file->variable.place);
    return SONJECT_OK;
}

static sonject_status load_element(struct report *report, struct mat_file *file)
{
    const struct mat_variable *variable = &file->variable;
    if (variable->bytes > SIZE_MAX)
        return report_out_of_memory(report, "an array");
    unsigned char *stored = allocate_array((size_t)variable->bytes, 1);
    if (!stored)
        return report_out_of_memory(report, "an array");
    if (!byte_file_read(file->file, variable->place, stored, (size_t)variable->bytes)) {
        free(stored);
        return damaged(report, file, variable->place);
    }
    if (!variable->is_compressed) {
        file->element = stored;
        file->element_bytes = (size_t)variable->bytes;
        return SONJECT_OK;
    }
    const sonject_status status =
        inflate_element(report, file, stored + MAT_TAG, (size_t)variable->bytes - MAT_TAG);
    free(stored);
    return status;
}

/* Where the numbers lie in the element. */
static sonject_status find_parts(struct report *report, struct mat_file *file)
{
    const struct mat_variable *variable = &file->variable;
    size_t place = variable->head;
    const uint64_t count = variable->rows * variable->columns;
    for (int i = 0; i < (variable->is_complex ? 2 : 1); i++) {
        struct mat_part *part = &file->parts[i];
        if (!mat_take_element(file->element, file->element_bytes, file->is_big_endian, &place,
                              part) ||
            mat_type_bytes(part->type) == 0 || part->bytes % mat_type_bytes(part->type) != 0 ||
            part->bytes / mat_type_bytes(part->type) != count)
            return damaged(report, file, variable->place);
    }
    return SONJECT_OK;
}

static sonject_status set_layout(struct report *report, struct mat_file *file)
{
    const struct mat_variable *variable = &file->variable;
    file->layout.rows = variable->rows;
    file->layout.columns = variable->columns;
    file->layout.channels = variable->is_complex ? 2 : 1;
    file->layout.type = variable->kind == MAT_CLASS_UINT8    ? PIXEL_UINT8
                        : variable->kind <= MAT_CLASS_SINGLE ? PIXEL_FLOAT32
                                                             : PIXEL_UINT16;
    if (mat_type_of_class(variable->kind) != 0 &&
        (!variable->is_complex || variable->kind <= MAT_CLASS_SINGLE))
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: the array %s is of numbers that sonject does not read: save it as "
                          "double, single, uint8, uint16 or int16, complex ones as double or "
                          "single",
                          file->path, variable->name);
}

static sonject_status read_file(struct report *report, struct mat_file *file, const char *array)
{
    unsigned char header[HEADER_BYTES];
    if (!byte_file_read(file->file, 0, header, sizeof header))
        return damaged(report, file, 0);
    file->is_big_endian = header[126] == 'M' && header[127] == 'I';
    if (!file->is_big_endian && !(header[126] == 'I' && header[127] == 'M'))
        return damaged(report, file, 126);
    sonject_status status = choose_variable(report, file, array);
    if (status == SONJECT_OK)
        status = set_layout(report, file);
    if (status == SONJECT_OK)
        status = load_element(report, file);
    if (status == SONJECT_OK)
        status = find_parts(report, file);
    return status;
}

sonject_status mat_file_open(struct report *report, const char *path, const char *array,
                             struct mat_file *file)
{
    memset(file, 0, sizeof *file);
    file->path = copy_text(path);
    if (!file->path)
        return report_out_of_memory(report, "a file name");
    file->file = byte_file_open(path, &file->file_bytes);
    sonject_status status = file->file ? SONJECT_OK : file_refuse(report, path, errno);
    if (status == SONJECT_OK)
        status = read_file(report, file, array);
    if (status != SONJECT_OK)
        mat_file_close(file);
    return status;
}

void mat_file_close(struct mat_file *file)
{
    if (file->file)
        fclose(file->file);
    free(file->path);
    free(file->element);
    memset(file, 0, sizeof *file);
}

uint32_t mat_file_largest(const struct mat_file *file)
{
    return file->variable.kind == MAT_CLASS_INT16 ? INT16_MAX : 0;
}

/* Puts a number where the image wants it; false if its type cannot hold it. */
static bool put_sample(enum pixel_type type, double number, void *pixels, size_t at)
{
    if (type == PIXEL_FLOAT32)
        return float_of_double(number, (float *)pixels + at);
    if (!(number >= 0.0 && number <= pixel_full_scale(type)))
        return false;
    if (type == PIXEL_UINT8)
        ((uint8_t *)pixels)[at] = (uint8_t)number;
    else
        ((uint16_t *)pixels)[at] = (uint16_t)number;
    return true;
}

sonject_status mat_file_read(struct report *report, const struct mat_file *file,
                             const struct region *region, void *pixels)
{
    const struct raster_layout *layout = &file->layout;
    if (!region_is_inside(layout, region))
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: the region is not inside the image",
                              file->path);
    for (uint64_t i = 0; i < region->rows * region->columns; i++) {
        const uint64_t row = region->first_row + i / region->columns;
        const uint64_t column = region->first_column + i % region->columns;
        const size_t index = (size_t)(column * layout->rows + row);
        for (uint32_t k = 0; k < layout->channels; k++) {
            const struct mat_part *part = &file->parts[k];
            const double number =
                mat_number(file->element + part->data + index * mat_type_bytes(part->type),
                           part->type, file->is_big_endian);
            if (!put_sample(layout->type, number, pixels, (size_t)i * layout->channels + k))
                return report_failure(report, SONJECT_ERROR_INPUT,
                                      "%s: the sample at row %llu, column %llu is negative or too "
                                      "large for its type (float32 for a double): sonject reads "
                                      "magnitudes, so convert the file first",
                                      file->path, (unsigned long long)row,
                                      (unsigned long long)column);
        }
    }
    return SONJECT_OK;
}
