#include "user/snippet.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"

#define WORD_CHARACTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789"

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
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: the code of a shape must be at most %zu KiB", name,
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
