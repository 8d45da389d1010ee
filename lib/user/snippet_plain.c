#include "user/snippet_plain.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

struct scan {
    struct report *report;
    const char *name;
    unsigned long line;
    const char *code;
    char *plain;
    size_t at;
};

static sonject_status refuse(const struct scan *scan, unsigned long line, const char *what)
{
    return report_failure(scan->report, SONJECT_ERROR_INPUT, "%s:%lu: %s", scan->name, line, what);
}

/* Bytes of a backslash and the line end that it joins, blanks between them allowed; 0: no splice.
 */
static size_t splice_at(const char *code)
{
    if (code[0] != '\\')
        return 0;
    const size_t blanks = strspn(code + 1, " \t\r");
    return code[1 + blanks] == '\n' ? blanks + 2 : 0;
}

/* Characters that are no text, or that a compiler may read as others even in comments. */
static const char *strange_at(const char *code)
{
    const unsigned char c = (unsigned char)code[0];
    if ((c < ' ' && c != '\n' && c != '\t' && c != '\r') || c == 127)
        return "control character; remove it";
    if (c == '?' && code[1] == '?' && code[2] != '\0' && strchr("=/'()!<>-", code[2]))
        return "trigraph; write the character that is meant, or a space between the signs";
    return NULL;
}

/* Brackets and # in disguise, outside of comments and quotes. */
static const char *digraph_at(const char *code)
{
    static const char *const digraphs[] = {"<%", "%>", "<:", ":>", "%:"};
    for (size_t i = 0; i < sizeof digraphs / sizeof *digraphs; i++)
        if (strncmp(code, digraphs[i], 2) == 0)
            return "digraph; write the bracket that is meant, or a space between the signs";
    return NULL;
}

/* Puts `with` for `count` characters; line ends stay. */
static void blank_out(struct scan *scan, size_t count, char line_end)
{
    for (size_t i = 0; i < count; i++, scan->at++) {
        const bool is_end = scan->code[scan->at] == '\n';
        scan->line += is_end;
        scan->plain[scan->at] = ' ';
        if (is_end)
            scan->plain[scan->at] = line_end;
    }
}

static sonject_status skip_line_comment(struct scan *scan)
{
    while (scan->code[scan->at] != '\0' && scan->code[scan->at] != '\n') {
        const size_t splice = splice_at(scan->code + scan->at);
        blank_out(scan, splice > 0 ? splice : 1, SPLICED_LINE);
    }
    return SONJECT_OK;
}

static sonject_status skip_block_comment(struct scan *scan)
{
    const unsigned long line = scan->line;
    const char *end = strstr(scan->code + scan->at + 2, "*/");
    if (!end)
        return refuse(scan, line, "this comment has no end; close it with */");
    blank_out(scan, (size_t)(end - (scan->code + scan->at)) + 2, SPLICED_LINE);
    return SONJECT_OK;
}

static sonject_status skip_quotes(struct scan *scan)
{
    const char quote = scan->code[scan->at];
    const unsigned long line = scan->line;
    blank_out(scan, 1, SPLICED_LINE);
    for (;;) {
        const char *code = scan->code + scan->at;
        const size_t splice = splice_at(code);
        if (code[0] == '\0' || code[0] == '\n')
            return refuse(scan, line, "this quote has no end on its line");
        if (splice > 0)
            blank_out(scan, splice, SPLICED_LINE);
        else
            blank_out(scan, code[0] == '\\' && code[1] != '\0' ? 2 : 1, SPLICED_LINE);
        if (code[0] == quote)
            return SONJECT_OK;
    }
}

static sonject_status step(struct scan *scan)
{
    const char *code = scan->code + scan->at;
    const size_t splice = splice_at(code);
    if (code[0] == '/' && code[1] == '/')
        return skip_line_comment(scan);
    if (code[0] == '/' && code[1] == '*')
        return skip_block_comment(scan);
    if (code[0] == '"' || code[0] == '\'')
        return skip_quotes(scan);
    if (splice > 0) {
        blank_out(scan, splice, SPLICED_LINE);
        return SONJECT_OK;
    }
    scan->line += code[0] == '\n';
    scan->plain[scan->at] = code[0] == '\r' ? ' ' : code[0];
    scan->at++;
    return SONJECT_OK;
}

/* first_line: of the text. */
static sonject_status find_strange(const struct scan *scan, unsigned long first_line,
                                   const char *text, const char *(*strange)(const char *))
{
    unsigned long line = first_line;
    for (size_t i = 0; text[i] != '\0'; i++) {
        const char *what = strange(text + i);
        if (what)
            return refuse(scan, line, what);
        line += text[i] == '\n' || text[i] == SPLICED_LINE;
    }
    return SONJECT_OK;
}

sonject_status snippet_plain(struct report *report, const char *name, uint32_t first_line,
                             const char *code, char **plain)
{
    struct scan scan = {report, name, first_line, code, copy_text(code), 0};
    *plain = NULL;
    if (!scan.plain)
        return report_out_of_memory(report, "a shape's code");
    sonject_status status = find_strange(&scan, first_line, code, strange_at);
    while (status == SONJECT_OK && code[scan.at] != '\0')
        status = step(&scan);
    if (status == SONJECT_OK)
        status = find_strange(&scan, first_line, scan.plain, digraph_at);
    if (status == SONJECT_OK)
        *plain = scan.plain;
    else
        free(scan.plain);
    return status;
}
