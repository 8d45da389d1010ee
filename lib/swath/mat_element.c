#include "swath/mat_element.h"

#include <string.h>

#include "base/byte_order.h"

#define FLAG_COMPLEX 0x0800u

size_t mat_type_bytes(uint32_t type)
{
    static const unsigned char bytes[] = {
        [MAT_INT8] = 1,  [MAT_UINT8] = 1,  [MAT_INT16] = 2,  [MAT_UINT16] = 2,
        [MAT_INT32] = 4, [MAT_UINT32] = 4, [MAT_SINGLE] = 4, [MAT_DOUBLE] = 8};
    return type < sizeof bytes ? bytes[type] : 0;
}

uint32_t mat_type_of_class(uint32_t kind)
{
    switch (kind) {
    case MAT_CLASS_DOUBLE:
        return MAT_DOUBLE;
    case MAT_CLASS_SINGLE:
        return MAT_SINGLE;
    case MAT_CLASS_UINT8:
        return MAT_UINT8;
    case MAT_CLASS_INT16:
        return MAT_INT16;
    case MAT_CLASS_UINT16:
        return MAT_UINT16;
    default:
        return 0;
    }
}

double mat_number(const unsigned char *bytes, uint32_t type, bool is_big_endian)
{
    const size_t size = mat_type_bytes(type);
    const uint64_t word = number_from_bytes(bytes, size, is_big_endian);
    if (type == MAT_DOUBLE) {
        double number;
        memcpy(&number, &word, sizeof number);
        return number;
    }
    if (type == MAT_SINGLE) {
        const uint32_t half = (uint32_t)word;
        float number;
        memcpy(&number, &half, sizeof number);
        return (double)number;
    }
    const bool is_signed = type == MAT_INT8 || type == MAT_INT16 || type == MAT_INT32;
    const double span = (double)(UINT64_C(1) << (8 * size));
    const bool is_negative = is_signed && word >> (8 * size - 1) != 0;
    return is_negative ? (double)word - span : (double)word;
}

void mat_set_number(unsigned char *bytes, uint32_t type, bool is_big_endian, double number)
{
    const size_t size = mat_type_bytes(type);
    uint64_t word = 0;
    if (type == MAT_DOUBLE) {
        memcpy(&word, &number, sizeof word);
    } else if (type == MAT_SINGLE) {
        const float single = (float)number;
        uint32_t half;
        memcpy(&half, &single, sizeof half);
        word = half;
    } else {
        word = (uint64_t)(int64_t)number;
    }
    number_to_bytes(word, bytes, size, is_big_endian);
}

bool mat_take_element(const unsigned char *bytes, size_t count, bool is_big_endian, size_t *place,
                      struct mat_part *part)
{
    if (*place > count || count - *place < MAT_TAG)
        return false;
    const unsigned char *tag = bytes + *place;
    const uint32_t first = (uint32_t)number_from_bytes(tag, 4, is_big_endian);
    const bool is_small = first >> 16 != 0;
    part->tag = *place;
    part->type = is_small ? first & 0xFFFF : first;
    part->bytes = is_small ? first >> 16 : (size_t)number_from_bytes(tag + 4, 4, is_big_endian);
    part->data = *place + (is_small ? 4 : MAT_TAG);
    if ((is_small && part->bytes > 4) || part->bytes > count - part->data)
        return false;
    *place = is_small ? *place + MAT_TAG : part->data + (part->bytes + 7) / 8 * 8;
    return true;
}

/* Class, sides and name; false if it is no array of numbers in two dimensions. */
static bool read_array_head(const unsigned char *bytes, size_t count, bool is_big_endian,
                            struct mat_variable *variable)
{
    struct mat_part flags, sides, name;
    size_t place = MAT_TAG;
    if (count < MAT_TAG || number_from_bytes(bytes, 4, is_big_endian) != MAT_MATRIX ||
        !mat_take_element(bytes, count, is_big_endian, &place, &flags) ||
        flags.type != MAT_UINT32 || flags.bytes != 8)
        return false;
    const uint64_t word = number_from_bytes(bytes + flags.data, 4, is_big_endian);
    variable->kind = (uint32_t)word & 0xFF;
    variable->is_complex = (word & FLAG_COMPLEX) != 0;
    if (variable->kind < MAT_CLASS_DOUBLE || variable->kind > MAT_CLASS_LAST_NUMERIC ||
        !mat_take_element(bytes, count, is_big_endian, &place, &sides) || sides.type != MAT_INT32 ||
        sides.bytes != 8 || !mat_take_element(bytes, count, is_big_endian, &place, &name) ||
        name.type != MAT_INT8 || name.bytes >= sizeof variable->name)
        return false;
    variable->rows = number_from_bytes(bytes + sides.data, 4, is_big_endian);
    variable->columns = number_from_bytes(bytes + sides.data + 4, 4, is_big_endian);
    memcpy(variable->name, bytes + name.data, name.bytes);
    variable->head = place;
    return variable->rows > 0 && variable->columns > 0 && variable->rows <= INT32_MAX &&
           variable->columns <= INT32_MAX;
}

void mat_read_head(const unsigned char *bytes, size_t count, bool is_big_endian,
                   struct mat_variable *variable)
{
    memset(variable->name, 0, sizeof variable->name);
    if (!read_array_head(bytes, count, is_big_endian, variable))
        variable->head = 0;
}
