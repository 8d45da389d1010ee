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
#define WORD_CHARACTERS  "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789"

static const char *const functions[] = {"shape_distance", "shape_normal"};
#define FUNCTIONS (sizeof functions / sizeof *functions)

/* Code on its way past a compiler's first passes. */
struct scan {
    struct report *report;
    const char *name;
    const char *at;
    unsigned long line;
    bool is_start; /* of a line: nothing but blanks and comments were before */
    bool has_function[FUNCTIONS];
};

static sonject_status refuse(const struct scan *scan, const char *what)
{
    return report_failure(scan->report, SONJECT_ERROR_INPUT, "%s:%lu: %s", scan->name, scan->line,
                          what);
}

static bool word_is(const char *word, size_t length, const char *text)
{
    return strlen(text) == length && memcmp(word, text, length) == 0;
}

/* Bytes of a backslash and the line end that it joins, blanks between them allowed; 0: none. */
static size_t splice_at(const char *code)
{
    if (code[0] != '\\')
        return 0;
    const size_t blanks = strspn(code + 1, " \t\r");
    return code[1 + blanks] == '\n' ? blanks + 2 : 0;
}

static bool is_line_end(char c)
{
    return c == '\n' || c == '\r' || c == '\0';
}

/* One character, or a splice. */
static void step(struct scan *scan)
{
    const size_t splice = splice_at(scan->at);
    scan->line += splice > 0 || *scan->at == '\n';
    scan->at += splice > 0 ? splice : 1;
}

/* A comment, or what is in quotes; false: none is here. Where one has no end a compiler says so. */
static bool skip_comment_or_quotes(struct scan *scan)
{
    const char quote = *scan->at;
    if (scan->at[0] == '/' && scan->at[1] == '/') {
        while (!is_line_end(*scan->at))
            step(scan);
        return true;
    }
    if (scan->at[0] == '/' && scan->at[1] == '*') {
        const char *end = strstr(scan->at + 2, "*/");
        end = end ? end + 2 : scan->at + strlen(scan->at);
        for (; scan->at < end; scan->at++)
            scan->line += *scan->at == '\n';
        return true;
    }
    if (quote != '"' && quote != '\'')
        return false;
    scan->is_start = false;
    do {
        if (scan->at[0] == '\\' && splice_at(scan->at) == 0 && !is_line_end(scan->at[1]))
            step(scan);
        step(scan);
    } while (!is_line_end(*scan->at) && *scan->at != quote);
    scan->at += *scan->at == quote;
    return true;
}

/* Reads on to the directive's name; what follows is text as any other. */
static sonject_status read_directive(struct scan *scan)
{
    static const char *const known[] = {"",     "define", "if",    "ifdef", "ifndef",
                                        "elif", "else",   "endif", "error"};
    scan->at++;
    scan->is_start = false;
    while (*scan->at == ' ' || *scan->at == '\t' || splice_at(scan->at) > 0 ||
           strncmp(scan->at, "/*", 2) == 0)
        if (!skip_comment_or_quotes(scan))
            step(scan);
    const size_t length = strspn(scan->at, WORD_CHARACTERS);
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (word_is(scan->at, length, known[i]))
            return SONJECT_OK;
    return report_failure(scan->report, SONJECT_ERROR_INPUT,
                          "%s:%lu: #%.*s is not possible here; known are #define, #if, #ifdef, "
                          "#ifndef, #elif, #else, #endif and #error",
                          scan->name, scan->line, length > 20 ? 20 : (int)length, scan->at);
}

static sonject_status read_word(struct scan *scan, size_t length)
{
    for (size_t i = 0; i < FUNCTIONS; i++)
        if (word_is(scan->at, length, functions[i]))
            scan->has_function[i] = true;
    if (word_is(scan->at, length, "_Pragma"))
        return refuse(scan, "_Pragma is not possible here; remove it");
    scan->at += length;
    scan->is_start = false;
    return SONJECT_OK;
}

static sonject_status read_token(struct scan *scan)
{
    const char c = *scan->at;
    const size_t length = strspn(scan->at, WORD_CHARACTERS);
    if (length > 0)
        return read_word(scan, length);
    if (scan->is_start && c == '#')
        return read_directive(scan);
    if (scan->is_start && strncmp(scan->at, "%:", 2) == 0)
        return refuse(scan, "digraph; write # instead");
    if (skip_comment_or_quotes(scan))
        return SONJECT_OK;
    if (is_line_end(c))
        scan->is_start = true;
    else if (c != ' ' && c != '\t' && splice_at(scan->at) == 0)
        scan->is_start = false;
    step(scan);
    return SONJECT_OK;
}

/* Characters that are no text, or that a compiler may read as others even in comments. */
static sonject_status find_strange(struct scan scan)
{
    for (; *scan.at != '\0'; scan.line += *scan.at == '\n', scan.at++) {
        const unsigned char c = (unsigned char)*scan.at;
        if ((c < ' ' && c != '\n' && c != '\t' && c != '\r') || c == 127)
            return refuse(&scan, "control character; remove it");
        if (c == '?' && scan.at[1] == '?' && scan.at[2] != '\0' && strchr("=/'()!<>-", scan.at[2]))
            return refuse(&scan, "trigraph; write the character that is meant, or a space between "
                                 "the signs");
    }
    return SONJECT_OK;
}

static sonject_status check_code(struct report *report, const struct user_snippet *snippet)
{
    struct scan scan = {report, snippet->name, snippet->code, snippet->first_line, true, {false}};
    sonject_status status = find_strange(scan);
    while (status == SONJECT_OK && *scan.at != '\0')
        status = read_token(&scan);
    for (size_t i = 0; status == SONJECT_OK && i < FUNCTIONS; i++)
        if (!scan.has_function[i])
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "%s:%lu: there is no function %s in it; write one", snippet->name,
                                  (unsigned long)snippet->first_line, functions[i]);
    return status;
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

static void copy_line(char *line, const char *text)
{
    size_t length = strcspn(text, "\n");
    length = length < LINE_CAPACITY - 1 ? length : LINE_CAPACITY - 1;
    memcpy(line, text, length);
    line[length] = '\0';
}

/* What follows the line. */
static const char *next_line(const char *text)
{
    text += strcspn(text, "\n");
    return text + (*text == '\n');
}

/* The first line that holds a word. */
static bool find_line(const char *log, const char *word, char *line)
{
    for (; *log != '\0'; log = next_line(log)) {
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
    for (const char *at = log; *at != '\0'; at = next_line(at)) {
        copy_line(text, at);
        if (text[0] != '\0')
            report_log(report, "%s", text);
    }
    if (!find_line(log, "error:", text) && !find_line(log, "fatal", text))
        text_excerpt(text, EXCERPT_CAPACITY, log);
    for (size_t end = strlen(text); end > 0 && strchr(" \n", text[end - 1]); end--)
        text[end - 1] = '\0';
    const char *what = find_place(text, &line);
    if (!what)
        return input_failure(report, snippet->name, "device '%s' cannot compile it: %s",
                             device_name, text);
    what = skip_to_words(what);
    if (line <= before)
        return input_failure(report, snippet->name, "%s", what);
    if (line > before + text_count_lines(snippet->code) + 1)
        return input_failure(report, snippet->name, "at its end: %s", what);
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
