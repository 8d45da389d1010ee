#define _POSIX_C_SOURCE 200809L
#include "swath/npy_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/byte_file.h"
#include "base/byte_order.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

#define HEADER_MAX 65536 /* bytes: of two numbers, a type and an order hundreds are written */
#define SIDE_MAX   (UINT64_C(1) << 40)

static const unsigned char mark[] = {0x93, 'N', 'U', 'M', 'P', 'Y'};

struct sample_kind {
    const char *description; /* without the byte order */
    enum pixel_type type;
    uint32_t channels;
    enum stored_number stored;
    uint32_t largest; /* as of struct sample_rows; larger ones are negative */
};

static const struct sample_kind kinds[] = {
    {"u1", PIXEL_UINT8, 1, STORED_AS_SHOWN, 0},
    {"u2", PIXEL_UINT16, 1, STORED_AS_SHOWN, 0},
    {"i2", PIXEL_UINT16, 1, STORED_AS_SHOWN, INT16_MAX},
    {"u4", PIXEL_FLOAT32, 1, STORED_UINT32, UINT32_MAX},
    {"i4", PIXEL_FLOAT32, 1, STORED_UINT32, INT32_MAX},
    {"f4", PIXEL_FLOAT32, 1, STORED_AS_SHOWN, 0},
    {"f8", PIXEL_FLOAT32, 1, STORED_FLOAT64, 0},
    {"c8", PIXEL_FLOAT32, 2, STORED_AS_SHOWN, 0},
    {"c16", PIXEL_FLOAT32, 2, STORED_FLOAT64, 0},
};

bool npy_begins(const unsigned char *bytes, size_t count)
{
    const size_t some = count < sizeof mark ? count : sizeof mark;
    return some >= 4 && memcmp(bytes, mark, some) == 0;
}

static sonject_status refuse(struct report *report, const struct sample_rows *rows,
                             const char *what)
{
    return report_failure(report, SONJECT_ERROR_INPUT, "%s: %s", rows->path, what);
}

/* What follows "'key':" in the header, less leading spaces; NULL if the key is not there. */
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

static bool read_type(const char *header, struct sample_rows *rows)
{
    const char *value = value_of(header, "descr");
    if (!value || (*value != '\'' && *value != '"') || value[1] == '\0' ||
        !strchr("<>|=", value[1]))
        return false;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        const size_t length = strlen(kinds[i].description);
        if (strncmp(value + 2, kinds[i].description, length) != 0 || value[2 + length] != *value)
            continue;
        rows->layout.type = kinds[i].type;
        rows->layout.channels = kinds[i].channels;
        rows->stored = kinds[i].stored;
        rows->largest = kinds[i].largest;
        rows->above_is_negative = true;
        rows->is_big_endian = value[1] == '>' || (value[1] == '=' && machine_is_big_endian());
        return true;
    }
    return false;
}

/* "(rows, columns)" and at most one more comma. */
static bool read_shape(const char *header, struct sample_rows *rows)
{
    const char *place = value_of(header, "shape");
    uint64_t *const sides[] = {&rows->layout.rows, &rows->layout.columns};
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
    return *place == ')' && rows->layout.rows > 0 && rows->layout.columns > 0;
}

static sonject_status take_header(struct report *report, const char *header,
                                  struct sample_rows *rows)
{
    const char *order = value_of(header, "fortran_order");
    size_t bytes;
    const bool is_transposed = order && strncmp(order, "True", 4) == 0;
    if (!order || !(is_transposed || strncmp(order, "False", 5) == 0) ||
        !value_of(header, "descr") || !value_of(header, "shape"))
        return refuse(report, rows,
                      "is not a NumPy array: its header lacks descr, fortran_order "
                      "or shape");
    if (!read_type(header, rows))
        return refuse(report, rows,
                      "has elements of a type that sonject does not read: save it as "
                      "uint8, 16 or 32 bit integers, float32, float64, complex64 or complex128");
    if (!read_shape(header, rows))
        return refuse(report, rows,
                      "is not two-dimensional: rows are track positions, columns "
                      "range cells");
    const struct region whole = {0, 0, rows->layout.rows, rows->layout.columns};
    const size_t size = rows->stored == STORED_FLOAT64 ? 2 : 1; /* of what the image takes */
    if (!region_bytes(&rows->layout, &whole, &bytes) || bytes > SIZE_MAX / size ||
        rows->file_bytes - rows->first_place < bytes * size)
        return refuse(report, rows, "is cut short: copy it again");
    rows->is_transposed = is_transposed;
    rows->row_bytes =
        bytes * size / (rows->is_transposed ? rows->layout.columns : rows->layout.rows);
    return SONJECT_OK;
}

static sonject_status read_header(struct report *report, struct sample_rows *rows)
{
    unsigned char start[12] = {0};
    if (!byte_file_read(rows->file, 0, start, 10))
        return refuse(report, rows, "is cut short: copy it again");
    const bool is_first_version = start[6] == 1;
    if (start[6] < 1 || start[6] > 3)
        return refuse(report, rows, "is of a version of NumPy's format that sonject does not know");
    if (!is_first_version && !byte_file_read(rows->file, 0, start, 12))
        return refuse(report, rows, "is cut short: copy it again");
    const uint64_t length = number_from_bytes(start + 8, is_first_version ? 2 : 4, false);
    const uint64_t place = is_first_version ? 10 : 12;
    if (length > HEADER_MAX || length > rows->file_bytes - place)
        return refuse(report, rows, "is damaged: its header is longer than the file");
    char *header = allocate_array((size_t)length + 1, 1);
    if (!header)
        return report_out_of_memory(report, "a header");
    rows->first_place = place + length;
    const sonject_status status = byte_file_read(rows->file, place, header, (size_t)length)
                                      ? take_header(report, header, rows)
                                      : refuse(report, rows, "is cut short: copy it again");
    free(header);
    return status;
}

sonject_status npy_file_open(struct report *report, const char *path, struct sample_rows *rows)
{
    return sample_rows_open(report, path, read_header, rows);
}
