/* NumPy arrays (.npy, versions 1 to 3): two-dimensional, in C or Fortran order, of u1, u2, i2, u4,
 * i4, f4, f8 (amplitudes), c8 or c16 (complex) in either byte order. Numbers of 32 and 64 bits are
 * shown as float32. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/byte_order.h"
#include "base/file.h"
#include "base/memory.h"
#include "swath/raster_file.h"
#include "swath/swath_format.h"

#define HEADER_MAX 65536 /* bytes; usual headers have hundreds */
#define NPY_HEADER 128   /* bytes in a new file; the format wants a multiple of 64 */
#define SIDE_MAX   (UINT64_C(1) << 40)

static const unsigned char mark[] = {0x93, 'N', 'U', 'M', 'P', 'Y'};

static const struct number_kind {
    const char *description; /* without the byte order */
    enum pixel_type type;
    uint32_t channels;
    enum stored_type stored;
    uint32_t largest;
} kinds[] = {
    {"u1", PIXEL_UINT8, 1, STORED_UINT8, 0},
    {"u2", PIXEL_UINT16, 1, STORED_UINT16, 0},
    {"i2", PIXEL_UINT16, 1, STORED_INT16, INT16_MAX},
    {"u4", PIXEL_FLOAT32, 1, STORED_UINT32, UINT32_MAX},
    {"i4", PIXEL_FLOAT32, 1, STORED_INT32, INT32_MAX},
    {"f4", PIXEL_FLOAT32, 1, STORED_FLOAT32, 0},
    {"f8", PIXEL_FLOAT32, 1, STORED_FLOAT64, 0},
    {"c8", PIXEL_FLOAT32, 2, STORED_FLOAT32, 0},
    {"c16", PIXEL_FLOAT32, 2, STORED_FLOAT64, 0},
};

static bool is_npy(struct swath_file *file, const unsigned char *head, size_t count)
{
    (void)file;
    const size_t some = count < sizeof mark ? count : sizeof mark;
    return some >= 4 && memcmp(head, mark, some) == 0;
}

/* Returns what follows "'key':" in the header, less leading spaces; NULL if there is no key. */
static const char *value_of(const char *header, const char *key)
{
    const char *place = strstr(header, key);
    if (!place)
        return NULL;
    place += strlen(key);
    place += strspn(place, "'\" ");
    if (*place != ':')
        return NULL;
    return place + 1 + strspn(place + 1, " ");
}

static bool read_type(const char *header, struct swath_file *file)
{
    const char *value = value_of(header, "descr");
    if (!value || (*value != '\'' && *value != '"') || value[1] == '\0' ||
        !strchr("<>|=", value[1]))
        return false;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        const size_t length = strlen(kinds[i].description);
        if (strncmp(value + 2, kinds[i].description, length) != 0 || value[2 + length] != *value)
            continue;
        file->layout.type = kinds[i].type;
        file->layout.channels = kinds[i].channels;
        file->lines.type = kinds[i].stored;
        file->largest = kinds[i].largest;
        file->lines.is_big_endian = value[1] == '>' || (value[1] == '=' && machine_is_big_endian());
        return true;
    }
    return false;
}

/* Reads "(rows, columns)", with at most one more comma. */
static bool read_shape(const char *header, struct swath_file *file)
{
    const char *place = value_of(header, "shape");
    uint64_t *const sides[] = {&file->layout.rows, &file->layout.columns};
    if (!place || *place++ != '(')
        return false;
    for (int i = 0; i < 2; i++) {
        place += strspn(place, " ");
        if (*place < '0' || *place > '9')
            return false;
        for (; *place >= '0' && *place <= '9'; place++) {
            *sides[i] = *sides[i] * 10 + (uint64_t)(*place - '0');
            if (*sides[i] > SIDE_MAX)
                return false;
        }
        place += strspn(place, " ");
        if (i == 0 && *place++ != ',')
            return false;
    }
    place += *place == ',';
    place += strspn(place, " ");
    return *place == ')' && file->layout.rows > 0 && file->layout.columns > 0;
}

static sonject_status take_header(struct report *report, const char *header,
                                  struct swath_file *file)
{
    const char *order = value_of(header, "fortran_order");
    size_t bytes;
    const bool is_transposed = order && strncmp(order, "True", 4) == 0;
    if (!order || !(is_transposed || strncmp(order, "False", 5) == 0) ||
        !value_of(header, "descr") || !value_of(header, "shape"))
        return input_failure(
            report, file->path,
            "is not a NumPy array: its header lacks descr, fortran_order or shape");
    if (!read_type(header, file))
        return input_failure(report, file->path,
                             "has elements of a type that sonject does not read: save it as uint8, "
                             "16 or 32 bit integers, float32, float64, complex64 or complex128");
    if (!read_shape(header, file))
        return input_failure(
            report, file->path,
            "is not two-dimensional: rows are track positions, columns range cells");
    const struct region whole = {0, 0, file->layout.rows, file->layout.columns};
    const size_t size = file->lines.type == STORED_FLOAT64 ? 2 : 1; /* times the image's bytes */
    if (!region_bytes(&file->layout, &whole, &bytes) || bytes > SIZE_MAX / size ||
        file->bytes - file->lines.first_place < bytes * size)
        return input_failure(report, file->path, "is cut short: copy it again");
    file->lines.is_transposed = is_transposed;
    file->lines.line_bytes =
        bytes * size / (file->lines.is_transposed ? file->layout.columns : file->layout.rows);
    return SONJECT_OK;
}

static sonject_status read_header(struct report *report, struct swath_file *file)
{
    unsigned char start[12] = {0};
    if (!byte_file_read(file->stream, 0, start, 10))
        return input_failure(report, file->path, "is cut short: copy it again");
    const bool is_first_version = start[6] == 1;
    if (start[6] < 1 || start[6] > 3)
        return input_failure(report, file->path,
                             "is of a version of NumPy's format that sonject does not know");
    if (!is_first_version && !byte_file_read(file->stream, 0, start, 12))
        return input_failure(report, file->path, "is cut short: copy it again");
    const uint64_t length = number_from_bytes(start + 8, is_first_version ? 2 : 4, false);
    const uint64_t place = is_first_version ? 10 : 12;
    if (length > HEADER_MAX || length > file->bytes - place)
        return input_failure(report, file->path, "is damaged: its header is longer than the file");
    char *header = allocate_array((size_t)length + 1, 1);
    CHECK_MEMORY(report, header, "a header");
    file->lines.first_place = place + length;
    const sonject_status status =
        byte_file_read(file->stream, place, header, (size_t)length)
            ? take_header(report, header, file)
            : input_failure(report, file->path, "is cut short: copy it again");
    free(header);
    return status;
}

static sonject_status open_npy(struct report *report, struct swath_file *file, int32_t channel,
                               const char *array)
{
    (void)channel;
    (void)array;
    return read_header(report, file);
}

const struct swath_format npy_format = {
    false, false, is_npy, open_npy, sample_lines_read, sample_lines_copy};

sonject_status npy_write(struct report *report, const char *path, enum pixel_type type,
                         bool is_complex, const uint64_t *sides, int side_count,
                         const void *numbers)
{
    char header[NPY_HEADER + 1];
    const char *name = type == PIXEL_UINT8    ? "u1"
                       : type == PIXEL_UINT16 ? "u2"
                       : is_complex           ? "c8"
                                              : "f4";
    const char order = type == PIXEL_UINT8 ? '|' : machine_is_big_endian() ? '>' : '<';
    size_t bytes = pixel_bytes(type) * (is_complex ? 2 : 1);
    memset(header, ' ', sizeof header);
    memcpy(header, "\x93NUMPY\x01\x00\x76\x00", 10); /* 118 bytes follow */
    int count = 10 + snprintf(header + 10, sizeof header - 10,
                              "{'descr': '%c%s', 'fortran_order': False, 'shape': (", order, name);
    for (int i = 0; i < side_count; i++) {
        bytes *= (size_t)sides[i];
        count += snprintf(header + count, sizeof header - (size_t)count, "%s%llu",
                          i > 0 ? ", " : "", (unsigned long long)sides[i]);
    }
    count += snprintf(header + count, sizeof header - (size_t)count, "), }");
    header[count] = ' ';
    header[NPY_HEADER - 1] = '\n';
    return file_write_parts(report, path, header, NPY_HEADER, numbers, bytes);
}
