#include "swath/mat_element.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include <zlib.h>

bool mat_can_inflate(void)
{
    return true;
}

bool mat_inflate(const unsigned char *compressed, size_t compressed_bytes, unsigned char *bytes,
                 size_t capacity, size_t *count)
{
    z_stream stream;
    size_t taken = 0;
    memset(&stream, 0, sizeof stream);
    *count = 0;
    if (inflateInit(&stream) != Z_OK)
        return false;
    int answer = Z_OK;
    while (answer == Z_OK && *count < capacity) {
        if (stream.avail_in == 0) {
            const size_t left = compressed_bytes - taken;
            stream.next_in = (Bytef *)(compressed + taken);
            stream.avail_in = left < INT_MAX ? (uInt)left : INT_MAX;
            taken += stream.avail_in;
        }
        const size_t room = capacity - *count < INT_MAX ? capacity - *count : INT_MAX;
        stream.next_out = bytes + *count;
        stream.avail_out = (uInt)room;
        answer = inflate(&stream, Z_NO_FLUSH);
        *count += room - stream.avail_out;
    }
    inflateEnd(&stream);
    return answer == Z_OK || answer == Z_STREAM_END || answer == Z_BUF_ERROR;
}

unsigned char *mat_deflate(const unsigned char *bytes, size_t count, size_t *compressed_bytes)
{
    uLongf room = count <= ULONG_MAX ? compressBound((uLong)count) : 0;
    unsigned char *compressed = room > count ? malloc(room) : NULL;
    if (!compressed ||
        compress2(compressed, &room, bytes, (uLong)count, Z_DEFAULT_COMPRESSION) != Z_OK) {
        free(compressed);
        return NULL;
    }
    *compressed_bytes = room;
    return compressed;
}
