#include "user/snippet.h"

#include <stdlib.h>
#include <string.h>

#include "base/growing_text.h"
#include "base/memory.h"
#include "base/text.h"
#include "user/snippet_words.h"

static const char *const functions[] = {"shape_distance", "shape_normal"};

static char *text_before(const struct user_snippet *snippet, const struct snippet_words *words,
                         uint32_t number)
{
    struct growing_text text = {NULL, 0, 0, false};
    for (size_t i = 0; i < words->names.count; i++) {
        const struct word *word = &words->names.words[i];
        const char *start = snippet->code + word->start;
        growing_text_add(&text, "#define %.*s user_%lu_%.*s\n", (int)word->length, start,
                         (unsigned long)number, (int)word->length, start);
    }
    growing_text_add(&text, "#line %lu \"%s\"\n", (unsigned long)snippet->first_line,
                     snippet->name);
    return growing_text_end(&text);
}

static void take_words_away(struct growing_text *text, const struct user_snippet *snippet,
                            const struct words *words)
{
    for (size_t i = 0; i < words->count; i++)
        growing_text_add(text, "#undef %.*s\n", (int)words->words[i].length,
                         snippet->code + words->words[i].start);
}

/* Starts a line of its own: the code may end without one, or in a backslash. */
static char *text_behind(const struct user_snippet *snippet, const struct snippet_words *words)
{
    struct growing_text text = {NULL, 0, 0, false};
    growing_text_add(&text, "\n\n#line 1 \"end of %s\"\n", snippet->name);
    take_words_away(&text, snippet, &words->names);
    take_words_away(&text, snippet, &words->macros);
    return growing_text_end(&text);
}

static sonject_status check_name(struct report *report, const char *name)
{
    if (name[0] == '\0' || strlen(name) > SNIPPET_NAME_MAX || !text_is_printable(name))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the name of a shape's code must be a text of 1 to %d bytes on one "
                              "line",
                              SNIPPET_NAME_MAX);
    return SONJECT_OK;
}

static sonject_status check_words(struct report *report, const struct user_snippet *snippet,
                                  const struct snippet_words *words)
{
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
        if (!words_hold(&words->names, snippet->code, functions[i]))
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "%s:%lu: there is no function %s in it; write one", snippet->name,
                                  (unsigned long)snippet->first_line, functions[i]);
        if (words_hold(&words->macros, snippet->code, functions[i]))
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "%s:%lu: %s must be a function, not a macro", snippet->name,
                                  (unsigned long)snippet->first_line, functions[i]);
    }
    return SONJECT_OK;
}

static sonject_status fill(struct report *report, struct user_snippet *snippet, uint32_t number)
{
    struct snippet_words words;
    for (char *c = snippet->name; *c != '\0'; c++)
        if (*c == '"' || *c == '\\')
            *c = '_';
    sonject_status status =
        snippet_words_read(report, snippet->name, snippet->first_line, snippet->code, &words);
    if (status != SONJECT_OK)
        return status;
    status = check_words(report, snippet, &words);
    if (status == SONJECT_OK) {
        snippet->before = text_before(snippet, &words, number);
        snippet->behind = text_behind(snippet, &words);
        if (!snippet->before || !snippet->behind)
            status = report_out_of_memory(report, "a shape's code");
    }
    snippet_words_clear(&words);
    return status;
}

sonject_status snippet_make(struct report *report, const char *name, uint32_t first_line,
                            const char *code, uint32_t number, struct user_snippet *snippet)
{
    memset(snippet, 0, sizeof *snippet);
    sonject_status status = check_name(report, name);
    if (status != SONJECT_OK)
        return status;
    if (strlen(code) > SNIPPET_BYTES_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: the code of a shape must be at most %zu KiB", name,
                              SNIPPET_BYTES_MAX >> 10);
    snippet->name = copy_text(name);
    snippet->code = copy_text(code);
    snippet->first_line = first_line > 0 ? first_line : 1;
    status = snippet->name && snippet->code ? fill(report, snippet, number)
                                            : report_out_of_memory(report, "a shape's code");
    if (status != SONJECT_OK)
        snippet_clear(snippet);
    return status;
}

void snippet_clear(struct user_snippet *snippet)
{
    free(snippet->name);
    free(snippet->code);
    free(snippet->before);
    free(snippet->behind);
    memset(snippet, 0, sizeof *snippet);
}
