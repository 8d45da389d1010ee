#include "base/memory.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
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

void *grow_doubling(void *list, size_t count, size_t size)
{
    size_t bytes;
    if ((count & (count - 1)) != 0)
        return list;
    return size_multiply(count > 0 ? 2 * count : 1, size, &bytes) ? realloc(list, bytes) : NULL;
}

sonject_status grow_list(struct report *report, void *list, size_t count, size_t size,
                         const char *what)
{
    void *old;
    memcpy(&old, list, sizeof old);
    char *grown = grow_doubling(old, count, size);
    CHECK_MEMORY(report, grown, what);
    memset(grown + count * size, 0, size);
    memcpy(list, &grown, sizeof grown);
    return SONJECT_OK;
}

bool memory_is_short(void)
{
    void *volatile much = allocate_array(1, (size_t)512 << 20); /* volatile: not optimised away */
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

static bool make_room(struct growing_text *text, size_t more)
{
    if (text->length + more + 1 <= text->capacity)
        return true;
    const size_t capacity = 2 * text->capacity + more + 1;
    char *grown = realloc(text->characters, capacity);
    if (!grown)
        return false;
    text->characters = grown;
    text->capacity = capacity;
    return true;
}

void growing_text_add(struct growing_text *text, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    if (text->failed)
        return;
    text->failed = length < 0 || !make_room(text, (size_t)length);
    if (text->failed)
        return;
    va_start(arguments, format);
    vsnprintf(text->characters + text->length, (size_t)length + 1, format, arguments);
    va_end(arguments);
    text->length += (size_t)length;
}

char *growing_text_end(struct growing_text *text)
{
    if (!text->failed && !text->characters)
        return copy_text("");
    if (!text->failed)
        return text->characters;
    free(text->characters);
    return NULL;
}

int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}
