#include "user/build_log.h"

#include <stdio.h>
#include <string.h>

#define LINE_CAPACITY 1024

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

/* Behind "name:" the number of a line, perhaps a column, then what is wrong. */
static bool read_place(const char *line, const char *name, unsigned long *number, const char **what)
{
    char start[SNIPPET_NAME_MAX + 2];
    snprintf(start, sizeof start, "%s:", name);
    for (const char *at = line; (at = strstr(at, start)) != NULL; at++) {
        const char *digits = at + strlen(start);
        const size_t count = strspn(digits, "0123456789");
        if (count == 0 || count > 9 || digits[count] != ':')
            continue;
        sscanf(digits, "%lu", number);
        const char *rest = digits + count + 1;
        const size_t column = strspn(rest, "0123456789");
        rest += column > 0 && rest[column] == ':' ? column + 1 : 0;
        rest += strspn(rest, " ");
        rest += strncmp(rest, "fatal ", 6) == 0 ? 6 : 0;
        rest += strncmp(rest, "error:", 6) == 0 ? 6 : 0;
        *what = rest + strspn(rest, " ");
        return true;
    }
    return false;
}

sonject_status explain_build_log(struct report *report, const struct user_shapes *shapes,
                                 const char *device_name, const char *log)
{
    char line[LINE_CAPACITY];
    const char *what;
    unsigned long number;
    tell_log(report, log);
    const bool has_error = find_error(log, line);
    for (uint32_t i = 0; has_error && i < shapes->snippet_count; i++) {
        const char *name = shapes->snippets[i].name;
        char behind[SNIPPET_NAME_MAX + 8];
        snprintf(behind, sizeof behind, "end of %s", name);
        if (read_place(line, behind, &number, &what)) {
            char copy[LINE_CAPACITY];
            copy_line(copy, what);
            rename_back(copy);
            return report_failure(report, SONJECT_ERROR_INPUT, "%s: at its end: %s", name, copy);
        }
        if (read_place(line, name, &number, &what)) {
            char copy[LINE_CAPACITY];
            copy_line(copy, what);
            rename_back(copy);
            return report_failure(report, SONJECT_ERROR_INPUT, "%s:%lu: %s", name, number, copy);
        }
    }
    if (!has_error)
        copy_line(line, log);
    rename_back(line);
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "device '%s' cannot build the user shapes' code: %s", device_name, line);
}
