#include "user/build_log.h"

#include <stdio.h>
#include <string.h>

#include "base/text.h"

#define LINE_CAPACITY    1024
#define EXCERPT_CAPACITY 400

static void copy_line(char *line, const char *text)
{
    size_t length = strcspn(text, "\n");
    length = length < LINE_CAPACITY - 1 ? length : LINE_CAPACITY - 1;
    memcpy(line, text, length);
    line[length] = '\0';
}

static void tell_log(struct report *report, const char *log)
{
    char line[LINE_CAPACITY];
    while (*log != '\0') {
        copy_line(line, log);
        if (line[0] != '\0')
            report_news(report, "%s", line);
        log += strcspn(log, "\n");
        log += *log == '\n';
    }
}

/* The first line that tells an error. */
static bool find_error(const char *log, char *line)
{
    for (; *log != '\0'; log += strcspn(log, "\n"), log += *log == '\n') {
        copy_line(line, log);
        if (strstr(line, "error:"))
            return true;
    }
    return false;
}

/* Takes our prefixes off the names of functions. */
static void rename_back(char *text)
{
    char *at = text;
    while ((at = strstr(at, "user_")) != NULL) {
        const size_t digits = strspn(at + 5, "0123456789");
        if (digits > 0 && at[5 + digits] == '_')
            memmove(at, at + 6 + digits, strlen(at + 6 + digits) + 1);
        else
            at += 5;
    }
}

/* A place that a line of a log tells. */
struct place {
    const char *start; /* in that line; NULL: none */
    const char *what;  /* is wrong there */
    const char *name;
    unsigned long line;
};

/* Where the line tells "name:" with the number of a line, perhaps a column, then what is wrong. */
static struct place find_place(const char *line, const char *name)
{
    struct place place = {NULL, NULL, name, 0};
    const size_t length = strlen(name);
    for (const char *at = line; (at = strstr(at, name)) != NULL; at++) {
        const char *digits = at + length + 1;
        if (at[length] != ':')
            continue;
        const size_t count = strspn(digits, "0123456789");
        if (count == 0 || count > 9)
            continue;
        for (size_t i = 0; i < count; i++)
            place.line = 10 * place.line + (unsigned long)(digits[i] - '0');
        place.start = at;
        place.what = digits + count;
        return place;
    }
    return place;
}

/* What is told behind a place: column, where macros were spelt, and the word error are left out. */
static const char *skip_to_words(const char *what)
{
    if (what[0] == ':' && what[1] >= '0' && what[1] <= '9')
        what += 1 + strspn(what + 1, "0123456789");
    what += strspn(what, " ");
    if (what[0] == '<' && strstr(what, ">: "))
        what = strstr(what, ">: ") + 1;
    what += strspn(what, ": ");
    what += strncmp(what, "fatal ", 6) == 0 ? 6 : 0;
    what += strncmp(what, "error:", 6) == 0 ? 6 : 0;
    return what + strspn(what, " ");
}

/* The first place in any of the snippets. */
static struct place first_place(const struct user_shapes *shapes, const char *line)
{
    struct place first = {NULL, NULL, NULL, 0};
    for (uint32_t i = 0; i < shapes->snippet_count; i++) {
        const struct place place = find_place(line, shapes->snippets[i].name);
        if (place.start && (!first.start || place.start < first.start))
            first = place;
    }
    return first;
}

sonject_status explain_build_log(struct report *report, const struct user_shapes *shapes,
                                 const char *device_name, const char *log)
{
    static const char behind[] = "end of ";
    char line[LINE_CAPACITY];
    tell_log(report, log);
    if (!find_error(log, line)) /* linkers say it in their own words */
        text_excerpt(line, EXCERPT_CAPACITY, log);
    for (size_t end = strlen(line); end > 0 && strchr(" \n", line[end - 1]); end--)
        line[end - 1] = '\0';
    rename_back(line);
    const struct place place = first_place(shapes, line);
    if (!place.start)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "device '%s' cannot build the user shapes' code: %s", device_name,
                              line);
    const char *what = skip_to_words(place.what);
    const size_t before = (size_t)(place.start - line);
    if (before >= sizeof behind - 1 &&
        strncmp(place.start - (sizeof behind - 1), behind, sizeof behind - 1) == 0)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: at its end: %s", place.name, what);
    return report_failure(report, SONJECT_ERROR_INPUT, "%s:%lu: %s", place.name, place.line, what);
}
