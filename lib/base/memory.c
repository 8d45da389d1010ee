#include "base/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

bool size_multiply(size_t a, size_t b, size_t *product)
{
    if (b != 0 && a > SIZE_MAX / b)
        return false;
    *product = a * b;
    return true;
}

void *allocate_array(size_t count, size_t size)
{
    size_t bytes;
    if (!size_multiply(count, size, &bytes))
        return NULL;
    return bytes == 0 ? calloc(1, 1) : calloc(count, size);
}

bool memory_is_short(void)
{
    void *volatile much = allocate_array(1, (size_t)512 << 20); /* volatile: that it is tried */
    const bool is_short = !much;
    free(much);
    return is_short;
}

char *copy_text(const char *text)
{
    size_t bytes = strlen(text) + 1;
    char *copy = malloc(bytes);
    if (copy)
        memcpy(copy, text, bytes);
    return copy;
}
