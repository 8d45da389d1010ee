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

/* Where the text tells ":" with the number of a line, then what is wrong; NULL: nowhere. */
static const char *find_place(const char *text, unsigned long *line)
{
    const char *what = NULL;
    for (; !what && (text = strchr(text, ':')) != NULL; text++)
        what = read_line_number(text, line);
    return what;
}

sonject_status explain_build_log(struct report *report, const struct user_snippet *snippet,
                                 const char *device_name, const char *log)
{
    char text[LINE_CAPACITY];
    unsigned long line;
    const unsigned long before = text_count_lines(SNIPPET_BEFORE);
    tell_log(report, log);
    if (!find_line(log, "error:", text) && !find_line(log, "fatal", text))
        text_excerpt(text, EXCERPT_CAPACITY, log);
    for (size_t end = strlen(text); end > 0 && strchr(" \n", text[end - 1]); end--)
        text[end - 1] = '\0';
    const char *what = find_place(text, &line);
    if (!what)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: device '%s' cannot compile it: %s",
                              snippet->name, device_name, text);
    what = skip_to_words(what);
    if (line <= before)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: %s", snippet->name, what);
    if (line > before + text_count_lines(snippet->code) + 1)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: at its end: %s", snippet->name,
                              what);
    return report_failure(report, SONJECT_ERROR_INPUT, "%s:%lu: %s", snippet->name,
                          snippet->first_line + (line - before - 1), what);
}
