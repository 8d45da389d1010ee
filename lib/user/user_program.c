#include "user/user_program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/growing_text.h"
#include "base/text.h"
#include "device/device.h"

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

typedef char parameters_are_as_many[USER_PARAMETERS == SONJECT_USER_PARAMETERS_CAPACITY ? 1 : -1];
typedef char snippets_are_units[USER_SNIPPETS_MAX == PROGRAM_UNITS_MAX ? 1 : -1];
typedef char user_record_is_packed[sizeof(struct user_record) == 18 * 4 ? 1 : -1];

struct user_record user_record_of(const struct user_shape *shape)
{
    struct user_record record;
    memset(&record, 0, sizeof record);
    record.snippet = (int32_t)shape->snippet;
    record.is_open = shape->is_open;
    memcpy(record.parameters, shape->parameters, sizeof record.parameters);
    return record;
}

/* A snippet as a translation unit. All that it declares is its own: the two functions since they
 * are declared static before, the rest by clang's attribute, or where the user wrote static. */
static char *text_of_unit(const struct user_snippet *snippet, unsigned long number)
{
    struct growing_text text = {NULL, 0, 0, false};
    growing_text_add(&text, SNIPPET_BEFORE "%s" SNIPPET_BEHIND, number, number, snippet->code);
    return growing_text_end(&text);
}

/* What the kernels call, which call the units by their numbers. */
static char *text_of_calls(unsigned long count)
{
    struct growing_text text = {NULL, 0, 0, false};
    growing_text_add(&text, "#line 1 \"calls of user shapes\"\n");
    for (unsigned long i = 0; i < count; i++)
        growing_text_add(&text,
                         "float user_%lu_distance(float3, float3, float, const float *);\n"
                         "float3 user_%lu_normal(float3, const float *);\n",
                         i, i);
    growing_text_add(
        &text, "float user_distance(int n, float3 p, float3 d, float t, const float *a)\n{\n");
    for (unsigned long i = 0; i < count; i++)
        growing_text_add(&text, "    if (n == %lu) return user_%lu_distance(p, d, t, a);\n", i, i);
    growing_text_add(&text, "    return INFINITY;\n}\n"
                            "float3 user_normal(int n, float3 p, const float *a)\n{\n");
    for (unsigned long i = 0; i < count; i++)
        growing_text_add(&text, "    if (n == %lu) return user_%lu_normal(p, a);\n", i, i);
    growing_text_add(&text, "    return (float3)(0.0f);\n}\n");
    return growing_text_end(&text);
}

static sonject_status explain(struct report *report, const struct device *device,
                              const void *shapes, size_t unit, const char *log)
{
    const struct user_shapes *users = shapes;
    return explain_build_log(report, &users->snippets[unit], device->name, log);
}

sonject_status user_kernel_create(struct report *report, struct device *device,
                                  const struct user_shapes *shapes, uint32_t variant,
                                  enum device_program number, const char *name,
                                  device_kernel *kernel)
{
    char *units[USER_SNIPPETS_MAX];
    char *calls = text_of_calls(shapes->snippet_count);
    bool is_complete = calls != NULL;
    *kernel = NULL;
    for (uint32_t i = 0; i < shapes->snippet_count; i++) {
        units[i] = text_of_unit(&shapes->snippets[i], i);
        is_complete = is_complete && units[i];
    }
    const struct user_code code = {calls, units, shapes->snippet_count, explain, shapes};
    const sonject_status status =
        is_complete ? kernel_create_with_code(report, device, number, variant, &code, name, kernel)
                    : report_out_of_memory(report, "the user shapes' program");
    for (uint32_t i = 0; i < shapes->snippet_count; i++)
        free(units[i]);
    free(calls);
    return status;
}

sonject_status scene_kernel_create(struct report *report, struct device *device,
                                   const struct scene *scene, uint32_t variant,
                                   enum device_program program, const char *name,
                                   device_kernel *kernel)
{
    if (scene->user_shapes.count == 0)
        return kernel_create(report, device, program, variant, name, kernel);
    return user_kernel_create(report, device, &scene->user_shapes, variant, program, name, kernel);
}
