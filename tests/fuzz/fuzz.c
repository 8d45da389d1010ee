#include "fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void fail(const char *what, const char *detail)
{
    fprintf(stderr, "%s: %s\n", what, detail);
    abort();
}

void fuzz_write(const char *path, const uint8_t *bytes, size_t count)
{
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, count, file) != count || fclose(file) != 0)
        fail("cannot write", path);
}

char *fuzz_text(const uint8_t *bytes, size_t count)
{
    char *text = malloc(count + 1);
    if (!text)
        fail("out of memory", "the input's copy");
    if (count > 0)
        memcpy(text, bytes, count);
    text[count] = '\0';
    return text;
}

static void expect(sonject_status status, const struct report *report, bool has_lines)
{
    if (status == SONJECT_OK)
        return;
    if (status != SONJECT_ERROR_INPUT && status != SONJECT_ERROR_STORAGE &&
        status != SONJECT_ERROR_UNSUPPORTED)
        fail(sonject_status_name(status), report->message);
    if (report->message[0] == '\0')
        fail("no message", sonject_status_name(status));
    for (const char *at = report->message; *at; at++)
        if ((unsigned char)*at < 0x20 && !(has_lines && *at == '\n' && (unsigned char)at[1] > 0x20))
            fail("not one line", report->message);
}

void fuzz_expect(sonject_status status, const struct report *report)
{
    expect(status, report, false);
}

void fuzz_expect_lines(sonject_status status, const struct report *report)
{
    expect(status, report, true);
}
