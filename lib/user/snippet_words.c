#include "user/snippet_words.h"

#include <stdlib.h>
#include <string.h>

#include "user/snippet_plain.h"

#define DEPTH_MAX      256
#define CONDITIONS_MAX 64

/* What the last token before a word was. */
enum token {
    TOKEN_OTHER,
    TOKEN_WORD,
    TOKEN_TAG, /* struct, union, enum */
    TOKEN_END  /* of a type: * or } */
};

struct reading {
    struct report *report;
    const char *name;
    const char *plain;
    unsigned long line;
    size_t at;
    char brackets[DEPTH_MAX];
    unsigned long bracket_lines[DEPTH_MAX];
    int depth;
    unsigned long condition_lines[CONDITIONS_MAX];
    int conditions;
    enum token last;
    bool is_value; /* behind the = of a variable outside of functions */
    struct snippet_words *words;
};

static bool starts_word(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static size_t word_length(const char *text)
{
    size_t length = 0;
    while (starts_word(text[length]) || (length > 0 && text[length] >= '0' && text[length] <= '9'))
        length++;
    return length;
}

static bool word_is(const char *word, size_t length, const char *text)
{
    return strlen(text) == length && memcmp(word, text, length) == 0;
}

bool words_hold(const struct words *words, const char *code, const char *text)
{
    for (size_t i = 0; i < words->count; i++)
        if (word_is(code + words->words[i].start, words->words[i].length, text))
            return true;
    return false;
}

static sonject_status refuse(const struct reading *reading, unsigned long line, const char *what)
{
    return report_failure(reading->report, SONJECT_ERROR_INPUT, "%s:%lu: %s", reading->name, line,
                          what);
}

static sonject_status keep_word(struct reading *reading, struct words *words, size_t start,
                                size_t length)
{
    for (size_t i = 0; i < words->count; i++)
        if (words->words[i].length == length &&
            memcmp(reading->plain + words->words[i].start, reading->plain + start, length) == 0)
            return SONJECT_OK;
    if (words->count == words->capacity) {
        const size_t capacity = words->capacity > 0 ? 2 * words->capacity : 16;
        struct word *grown = realloc(words->words, capacity * sizeof *grown);
        if (!grown)
            return report_out_of_memory(reading->report, "a shape's code");
        words->words = grown;
        words->capacity = capacity;
    }
    words->words[words->count++] = (struct word){start, length};
    return SONJECT_OK;
}

static sonject_status open_bracket(struct reading *reading)
{
    if (reading->depth == DEPTH_MAX)
        return refuse(reading, reading->line, "brackets are nested too deeply");
    reading->bracket_lines[reading->depth] = reading->line;
    reading->brackets[reading->depth++] = reading->plain[reading->at];
    reading->last = TOKEN_OTHER;
    return SONJECT_OK;
}

static sonject_status close_bracket(struct reading *reading)
{
    const char closing = reading->plain[reading->at];
    const char opening = closing == ')' ? '(' : closing == ']' ? '[' : '{';
    if (reading->depth == 0 || reading->brackets[reading->depth - 1] != opening)
        return refuse(reading, reading->line,
                      closing == '}'   ? "this } closes no {"
                      : closing == ')' ? "this ) closes no ("
                                       : "this ] closes no [");
    reading->depth--;
    reading->last = closing == '}' ? TOKEN_END : TOKEN_OTHER;
    return SONJECT_OK;
}

/* Whether a word outside of functions is declared here: the name of a type, or what follows a type
 * and comes before one of ([=;, */
static bool is_declared(const struct reading *reading, size_t length)
{
    const char *rest = reading->plain + reading->at + length;
    rest += strspn(rest, " \t\n\v");
    if (reading->last == TOKEN_TAG)
        return true;
    return !reading->is_value && (reading->last == TOKEN_WORD || reading->last == TOKEN_END) &&
           *rest != '\0' && strchr("([=;,", *rest);
}

static sonject_status read_word(struct reading *reading)
{
    const char *word = reading->plain + reading->at;
    const size_t length = word_length(word);
    const bool is_tag = word_is(word, length, "struct") || word_is(word, length, "union") ||
                        word_is(word, length, "enum");
    sonject_status status = SONJECT_OK;
    if (word_is(word, length, "_Pragma"))
        return refuse(reading, reading->line, "_Pragma is not possible here; remove it");
    if (reading->depth == 0 && !is_tag && strncmp(word, "__", 2) != 0 &&
        is_declared(reading, length))
        status = keep_word(reading, &reading->words->names, reading->at, length);
    reading->last = is_tag ? TOKEN_TAG : TOKEN_WORD;
    reading->at += length;
    return status;
}

static sonject_status read_macro(struct reading *reading, const char *rest)
{
    rest += strspn(rest, " \t\v");
    const size_t length = word_length(rest);
    if (length == 0)
        return refuse(reading, reading->line, "#define needs a name");
    if (strncmp(rest, "__", 2) == 0)
        return refuse(reading, reading->line,
                      "macros must not start with __, which are the compiler's; rename it");
    return keep_word(reading, &reading->words->macros, (size_t)(rest - reading->plain), length);
}

static sonject_status read_condition(struct reading *reading, const char *word, size_t length)
{
    if (word_is(word, length, "endif")) {
        if (reading->conditions == 0)
            return refuse(reading, reading->line, "this #endif ends no #if");
        reading->conditions--;
    } else if (word_is(word, length, "else") || word_is(word, length, "elif")) {
        if (reading->conditions == 0)
            return refuse(reading, reading->line, "this #else belongs to no #if");
    } else {
        if (reading->conditions == CONDITIONS_MAX)
            return refuse(reading, reading->line, "conditions are nested too deeply");
        reading->condition_lines[reading->conditions++] = reading->line;
    }
    return SONJECT_OK;
}

static sonject_status read_directive(struct reading *reading)
{
    static const char *const conditions[] = {"if", "ifdef", "ifndef", "elif", "else", "endif"};
    const char *word = reading->plain + reading->at + 1;
    word += strspn(word, " \t\v");
    const size_t length = word_length(word);
    sonject_status status = SONJECT_OK;
    bool is_known = length == 0 || word_is(word, length, "error");
    if (word_is(word, length, "define")) {
        is_known = true;
        status = read_macro(reading, word + length);
    }
    for (size_t i = 0; i < sizeof conditions / sizeof *conditions; i++)
        if (word_is(word, length, conditions[i])) {
            is_known = true;
            status = read_condition(reading, word, length);
        }
    if (!is_known)
        return report_failure(reading->report, SONJECT_ERROR_INPUT,
                              "%s:%lu: #%.*s is not possible here; known are #define, #if, #ifdef, "
                              "#ifndef, #elif, #else, #endif and #error",
                              reading->name, reading->line, length > 20 ? 20 : (int)length, word);
    while (reading->plain[reading->at] != '\0' && reading->plain[reading->at] != '\n') {
        reading->line += reading->plain[reading->at] == SPLICED_LINE;
        reading->at++;
    }
    return status;
}

/* is_start: nothing but blanks before it on its line. */
static sonject_status read_token(struct reading *reading, bool is_start)
{
    const char c = reading->plain[reading->at];
    sonject_status status = SONJECT_OK;
    if (c == '#') {
        if (!is_start)
            return refuse(reading, reading->line, "# must start its line");
        return read_directive(reading);
    }
    if (starts_word(c))
        return read_word(reading);
    if (strchr("({[", c))
        status = open_bracket(reading);
    else if (strchr(")}]", c))
        status = close_bracket(reading);
    else
        reading->last = c == '*' ? TOKEN_END : TOKEN_OTHER;
    if (reading->depth == 0 && c == '=')
        reading->is_value = true;
    if (reading->depth == 0 && c == ',' && !reading->is_value)
        reading->last = TOKEN_WORD; /* another one of the same type */
    if (reading->depth == 0 && c == ',' && reading->is_value) {
        reading->is_value = false;
        reading->last = TOKEN_WORD;
    }
    if (reading->depth == 0 && c == ';')
        reading->is_value = false;
    reading->at++;
    return status;
}

static sonject_status read_all(struct reading *reading)
{
    sonject_status status = SONJECT_OK;
    bool is_start = true;
    while (status == SONJECT_OK && reading->plain[reading->at] != '\0') {
        const char c = reading->plain[reading->at];
        if (c == '\n' || c == SPLICED_LINE || c == ' ' || c == '\t') {
            is_start = c == '\n' || is_start;
            reading->line += c == '\n' || c == SPLICED_LINE;
            reading->at++;
            continue;
        }
        status = read_token(reading, is_start);
        is_start = false;
    }
    if (status != SONJECT_OK)
        return status;
    if (reading->depth > 0)
        return report_failure(
            reading->report, SONJECT_ERROR_INPUT, "%s:%lu: this %c is never closed", reading->name,
            reading->bracket_lines[reading->depth - 1], reading->brackets[reading->depth - 1]);
    if (reading->conditions > 0)
        return refuse(reading, reading->condition_lines[reading->conditions - 1],
                      "this #if has no #endif");
    return SONJECT_OK;
}

sonject_status snippet_words_read(struct report *report, const char *name, uint32_t first_line,
                                  const char *code, struct snippet_words *words)
{
    char *plain;
    struct reading reading;
    memset(words, 0, sizeof *words);
    sonject_status status = snippet_plain(report, name, first_line, code, &plain);
    if (status != SONJECT_OK)
        return status;
    memset(&reading, 0, sizeof reading);
    reading.report = report;
    reading.name = name;
    reading.plain = plain;
    reading.line = first_line;
    reading.words = words;
    status = read_all(&reading);
    free(plain);
    if (status != SONJECT_OK)
        snippet_words_clear(words);
    return status;
}

void snippet_words_clear(struct snippet_words *words)
{
    free(words->names.words);
    free(words->macros.words);
    memset(words, 0, sizeof *words);
}
