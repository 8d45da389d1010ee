#include "base/growing_text.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"

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

sonject_status growing_text_write(struct report *report, struct growing_text *text,
                                  const char *path)
{
    char *whole = growing_text_end(text);
    CHECK_MEMORY(report, whole, path);
    const sonject_status status = file_write_whole(report, path, whole, strlen(whole));
    free(whole);
    return status;
}
