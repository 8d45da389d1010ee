#include "user/snippet.h"
#include "base/file.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "scene/scene.h"

#define LINE_CAPACITY    1024
#define EXCERPT_CAPACITY 400

static const char *const functions[] = {"shape_distance", "shape_normal"};
#define FUNCTIONS (sizeof functions / sizeof *functions)

/* The first line with an #include, which would bring in what neither a scene's hash nor a cache of
 * programs knows; 0: none has one. */
static unsigned long find_include(const char *code)
{
    for (unsigned long line = 1; code; line++) {
        code += strspn(code, " \t");
        if (*code == '#' && strncmp(code + 1 + strspn(code + 1, " \t"), "include", 7) == 0)
            return line;
        code = strchr(code, '\n');
        code = code ? code + 1 : NULL;
    }
    return 0;
}

/* Compilers tell the rest. */
static sonject_status check_code(struct report *report, const struct user_snippet *snippet)
{
    const unsigned long line = find_include(snippet->code);
    if (line > 0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s:%lu: #include is not possible here; write here what is in that "
                              "file",
                              snippet->name, snippet->first_line + line - 1);
    for (size_t i = 0; i < FUNCTIONS; i++)
        if (!strstr(snippet->code, functions[i]))
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "%s:%lu: there is no function %s in it; write one", snippet->name,
                                  (unsigned long)snippet->first_line, functions[i]);
    return SONJECT_OK;
}

sonject_status snippet_make(struct report *report, const char *name, uint32_t first_line,
                            const char *code, struct user_snippet *snippet)
{
    memset(snippet, 0, sizeof *snippet);
    if (name[0] == '\0' || strlen(name) > SNIPPET_NAME_MAX || !text_is_printable(name))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the name of a shape's code must be a text of 1 to %d bytes on one "
                              "line",
                              SNIPPET_NAME_MAX);
    if (strlen(code) > SNIPPET_BYTES_MAX)
        return input_failure(report, name, "the code of a shape must be at most %zu KiB",
                             SNIPPET_BYTES_MAX >> 10);
    snippet->name = copy_text(name);
    snippet->code = copy_text(code);
    snippet->first_line = first_line > 0 ? first_line : 1;
    const sonject_status status = snippet->name && snippet->code
                                      ? check_code(report, snippet)
                                      : report_out_of_memory(report, "a shape's code");
    if (status != SONJECT_OK)
        snippet_clear(snippet);
    return status;
}

void snippet_clear(struct user_snippet *snippet)
{
    free(snippet->name);
    free(snippet->code);
    memset(snippet, 0, sizeof *snippet);
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

/* Says that the next line is the first one of the user's file. */
static void add_place(struct growing_text *text, const struct user_snippet *snippet)
{
    growing_text_add(text, "#line %lu \"", (unsigned long)snippet->first_line);
    for (const char *c = snippet->name; *c; c++)
        growing_text_add(text, "%s%c", strchr("\"\\?", *c) ? "\\" : "", *c);
    growing_text_add(text, "\"\n");
}

/* A snippet as a translation unit. All that it declares is its own: the two functions since they
 * are declared static before, the rest by clang's attribute, or where the user wrote static. */
static char *text_of_unit(const struct user_snippet *snippet, unsigned long number)
{
    struct growing_text text = {NULL, 0, 0, false};
    growing_text_add(&text, SNIPPET_BEFORE);
    add_place(&text, snippet);
    growing_text_add(&text, SNIPPET_FUNCTIONS, number, number);
    add_place(&text, snippet);
    growing_text_add(&text, "%s" SNIPPET_BEHIND, snippet->code);
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

/* The first error, from the user's line on where it has one; the whole log goes to the report's. */
static sonject_status explain(struct report *report, const struct device *device,
                              const void *shapes, size_t unit, const char *log)
{
    const struct user_shapes *users = shapes;
    const char *name = users->snippets[unit].name;
    char text[LINE_CAPACITY], error[LINE_CAPACITY] = "";
    for (const char *at = log; *at != '\0'; at += *at == '\n') {
        const size_t length = strcspn(at, "\n");
        snprintf(text, sizeof text, "%.*s", (int)length, at);
        if (length > 0)
            report_log(report, "%s", text);
        if (!*error && (strstr(text, "error:") || strstr(text, "fatal")))
            memcpy(error, text, sizeof text);
        at += length;
    }
    if (!*error)
        text_excerpt(error, EXCERPT_CAPACITY, log);
    text_make_printable(error);
    const char *place = strstr(error, name);
    return place ? report_failure(report, SONJECT_ERROR_INPUT, "%s", place)
                 : input_failure(report, name, "device '%s' cannot compile it: %s", device->name,
                                 error);
}

sonject_status user_kernel_create(struct report *report, struct device *device,
                                  const struct user_shapes *shapes, enum program_variant variant,
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
                                   const struct scene *scene, enum program_variant variant,
                                   enum device_program program, const char *name,
                                   device_kernel *kernel)
{
    if (scene->user_shapes.count == 0)
        return kernel_create(report, device, program, variant, name, kernel);
    return user_kernel_create(report, device, &scene->user_shapes, variant, program, name, kernel);
}
