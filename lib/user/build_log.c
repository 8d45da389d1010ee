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

/* The first line that holds a word. */
static bool find_line(const char *log, const char *word, char *line)
{
    for (; *log != '\0'; log += strcspn(log, "\n"), log += *log == '\n') {
        copy_line(line, log);
        if (strstr(line, word))
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
    bool is_behind; /* the code, in what ends it */
};

/* Reads ":" and the number of a line; returns what follows, NULL where these do not stand here. */
static const char *read_line_number(const char *at, unsigned long *line)
{
    const size_t count = *at == ':' ? strspn(at + 1, "0123456789") : 0;
    *line = 0;
    if (count == 0 || count > 9)
        return NULL;
    for (size_t i = 1; i <= count; i++)
        *line = 10 * *line + (unsigned long)(at[i] - '0');
    return at + 1 + count;
}

static bool ends_with(const char *start, const char *end, const char *words)
{
    const size_t length = strlen(words);
    return (size_t)(end - start) >= length && strncmp(end - length, words, length) == 0;
}

/* Where the line tells "name:" with the number of a line, perhaps a column, then what is wrong. */
static struct place find_place(const char *line, const char *name)
{
    struct place place = {NULL, NULL, name, 0, false};
    for (const char *at = line; (at = strstr(at, name)) != NULL; at++) {
        place.what = read_line_number(at + strlen(name), &place.line);
        if (!place.what)
            continue;
        place.start = at;
        place.is_behind = ends_with(line, at, "end of ");
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
    struct place first = {NULL, NULL, NULL, 0, false};
    for (uint32_t i = 0; i < shapes->snippet_count; i++) {
        const struct place place = find_place(line, shapes->snippets[i].name);
        if (place.start && (!first.start || place.start < first.start))
            first = place;
    }
    return first;
}

/* The place of a line of the whole program, which "<any name>:" stands before. */
static struct place place_in_program(const struct user_text *text, const char *line)
{
    struct place place = {NULL, NULL, NULL, 0, false};
    unsigned long number;
    const char *start = strchr(line, '<');
    const char *end = start ? strchr(start, '>') : NULL;
    place.what = end ? read_line_number(end + 1, &number) : NULL;
    if (!place.what)
        return place;
    unsigned long first = 1 + text->lines_before;
    for (uint32_t i = 0; i < text->shapes->snippet_count; i++) {
        const struct user_snippet *snippet = &text->shapes->snippets[i];
        const unsigned long code = first + text_count_lines(snippet->before);
        const unsigned long behind = code + text_count_lines(snippet->code);
        first = behind + text_count_lines(snippet->behind);
        if (number < code || number > first)
            continue;
        place.start = start;
        place.name = snippet->name;
        place.line = snippet->first_line + (number - code);
        place.is_behind = number > behind;
        return place;
    }
    return place;
}

sonject_status explain_build_log(struct report *report, const struct user_text *text,
                                 const char *device_name, const char *log)
{
    char line[LINE_CAPACITY];
    tell_log(report, log);
    /* linkers say it in their own words */
    if (!find_line(log, "error:", line) && !find_line(log, "fatal", line))
        text_excerpt(line, EXCERPT_CAPACITY, log);
    for (size_t end = strlen(line); end > 0 && strchr(" \n", line[end - 1]); end--)
        line[end - 1] = '\0';
    rename_back(line);
    struct place place = first_place(text->shapes, line);
    if (!place.start)
        place = place_in_program(text, line);
    if (!place.start)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "device '%s' cannot build the user shapes' code: %s", device_name,
                              line);
    const char *what = skip_to_words(place.what);
    if (place.is_behind)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: at its end: %s", place.name, what);
    return report_failure(report, SONJECT_ERROR_INPUT, "%s:%lu: %s", place.name, place.line, what);
}
