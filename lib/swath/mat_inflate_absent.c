/* Stands in for mat_inflate.c in builds without zlib. */
#include "swath/mat_element.h"

bool mat_can_inflate(void)
{
    return false;
}

bool mat_inflate(const unsigned char *compressed, size_t compressed_bytes, unsigned char *bytes,
                 size_t capacity, size_t *count)
{
    (void)compressed;
    (void)compressed_bytes;
    (void)bytes;
    (void)capacity;
    *count = 0;
    return false;
}

unsigned char *mat_deflate(const unsigned char *bytes, size_t count, size_t *compressed_bytes)
{
    (void)bytes;
    (void)count;
    (void)compressed_bytes;
    return NULL;
}
