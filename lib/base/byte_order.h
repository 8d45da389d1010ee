/* Numbers in files of either byte order. */
#ifndef SONJECT_BASE_BYTE_ORDER_H
#define SONJECT_BASE_BYTE_ORDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

static inline bool machine_is_big_endian(void)
{
    const uint16_t one = 1;
    unsigned char first;
    memcpy(&first, &one, 1);
    return first == 0;
}

/* count: 1...8 */
static inline uint64_t number_from_bytes(const unsigned char *bytes, size_t count,
                                         bool is_big_endian)
{
    uint64_t number = 0;
    for (size_t i = 0; i < count; i++)
        number = number << 8 | bytes[is_big_endian ? i : count - 1 - i];
    return number;
}

static inline void number_to_bytes(uint64_t number, unsigned char *bytes, size_t count,
                                   bool is_big_endian)
{
    for (size_t i = 0; i < count; i++) {
        bytes[is_big_endian ? count - 1 - i : i] = (unsigned char)(number & 0xFF);
        number >>= 8;
    }
}

#endif
