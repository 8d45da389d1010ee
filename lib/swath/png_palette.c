#include "swath/png_palette.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "base/byte_file.h"
#include "base/byte_order.h"
#include "base/file.h"

#define BITS_PLACE    24 /* in the header, which comes first */
#define COLOURS_PLACE 25
#define BY_PALETTE    3
#define NUMBERS_CHUNK "soNu"

/* Returns what is behind it. */
static unsigned char *put_chunk(unsigned char *to, const char *name, const void *content,
                                size_t count)
{
    uint32_t sum = UINT32_C(0xFFFFFFFF);
    number_to_bytes(count, to, 4, true);
    memcpy(to + 4, name, 4);
    memcpy(to + 8, content, count);
    for (size_t i = 4; i < 8 + count; i++) {
        sum ^= to[i];
        for (int bit = 0; bit < 8; bit++)
            sum = sum & 1 ? sum >> 1 ^ UINT32_C(0xEDB88320) : sum >> 1;
    }
    number_to_bytes(~(uint64_t)sum, to + 8 + count, 4, true);
    return to + count + 12;
}

static bool colour(FILE *from, uint64_t bytes, const uint8_t *palette, FILE *to)
{
    const size_t place = PNG_HEADER_PLACE + PNG_HEADER_BYTES;
    unsigned char header[PNG_HEADER_PLACE + PNG_HEADER_BYTES];
    unsigned char head[PNG_COLOURED_BYTES];
    if (bytes < place || !byte_file_read(from, 0, header, place))
        return false;
    memcpy(head, header, place);
    head[COLOURS_PLACE] = BY_PALETTE;
    unsigned char *next = put_chunk(head + PNG_HEADER_PLACE, "IHDR", head + PNG_HEADER_PLACE + 8,
                                    PNG_HEADER_BYTES - 12);
    next = put_chunk(next, "PLTE", palette, PNG_PALETTE_BYTES);
    put_chunk(next, NUMBERS_CHUNK, header + PNG_HEADER_PLACE, PNG_HEADER_BYTES);
    return fwrite(head, 1, sizeof head, to) == sizeof head &&
           byte_file_copy(from, place, bytes - place, to);
}

sonject_status png_colour(struct report *report, const char *grey, const uint8_t *palette,
                          const char *result, const char *name)
{
    uint64_t bytes = 0;
    errno = 0;
    FILE *from = byte_file_open(grey, &bytes);
    FILE *to = from ? fopen(result, "wb") : NULL;
    bool is_good = to && colour(from, bytes, palette, to);
    if (to && fclose(to) != 0)
        is_good = false;
    const int error = errno;
    if (from)
        fclose(from);
    return is_good ? SONJECT_OK : file_failure(report, name, "write", error != 0 ? error : EIO);
}

sonject_status png_check(struct report *report, const char *name, const char *path,
                         bool *is_coloured)
{
    unsigned char head[PNG_COLOURED_BYTES] = {0};
    uint64_t bytes;
    FILE *file = byte_file_open(path, &bytes);
    if (!file)
        return file_refuse(report, name, errno);
    (void)fread(head, 1, sizeof head, file);
    const int error = ferror(file) ? errno : 0;
    fclose(file);
    if (error != 0)
        return file_failure(report, name, "read", error);
    *is_coloured = head[COLOURS_PLACE] == BY_PALETTE &&
                   memcmp(head + PNG_NUMBERS_PLACE - 4, NUMBERS_CHUNK, 4) == 0;
    if (head[COLOURS_PLACE] == BY_PALETTE && !*is_coloured)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: has a palette; convert it to one channel first", name);
    if (head[BITS_PLACE] != 8 && head[BITS_PLACE] != 16)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: has %u-bit pixels; sonject reads PNG with 8 or 16: convert it "
                              "to one of these",
                              name, head[BITS_PLACE]);
    return SONJECT_OK;
}
