#include "mesh/words.h"

#include <math.h>
#include <string.h>

#include "base/text.h"

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

static bool ends_word(char c)
{
    return c == '\0' || c == '\n' || is_blank(c);
}

bool words_on_line(struct words *words)
{
    for (; words->at < words->end; words->at++) {
        const char *next = words->at + 1;
        if (*words->at == '\\') {
            next += *next == '\r';
            if (*next != '\n')
                return true;
            words->at = next;
            words->line++;
        } else if (*words->at == '\n') {
            return false;
        } else if (!is_blank(*words->at)) {
            return true;
        }
    }
    return false;
}

void words_skip_line(struct words *words)
{
    const char *end = memchr(words->at, '\n', (size_t)(words->end - words->at));
    words->at = end ? end + 1 : words->end;
    words->line += end != NULL;
}

bool words_left(struct words *words, char comment)
{
    for (;;) {
        if (words_on_line(words)) {
            if (comment == '\0' || *words->at != comment)
                return true;
            words_skip_line(words);
        } else if (words->at >= words->end) {
            return false;
        } else {
            words->at++;
            words->line++;
        }
    }
}

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

bool words_accept(struct words *words, const char *word)
{
    const char *at = words->at;
    for (; *word; word++, at++)
        if (lower(*at) != *word)
            return false;
    if (!ends_word(*at))
        return false;
    words->at = at;
    return true;
}

sonject_status words_failure(const struct words *words, const char *what)
{
    char word[40];
    size_t length = 0;
    const size_t left = (size_t)(words->end - words->at);
    while (length < left && length < sizeof word - 1 && !ends_word(words->at[length])) {
        const char c = words->at[length];
        word[length++] = c > 0x20 && c < 0x7f ? c : '?';
    }
    word[length] = '\0';
    if (left == 0)
        return report_failure(words->report, SONJECT_ERROR_INPUT,
                              "%s, line %zu: expected %s, but the file ends here: it is cut short",
                              words->path, words->line, what);
    return report_failure(words->report, SONJECT_ERROR_INPUT,
                          "%s, line %zu: expected %s, found '%s'", words->path, words->line, what,
                          length > 0 ? word : "end of line");
}

/* A number of few digits, exactly: one rounding of a whole number times or over a power of ten that
 * is exact itself. False if it takes more than that. */
static bool read_short_number(const char *at, const char **rest, double *number)
{
    static const double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                    1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                    1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const bool is_negative = *at == '-';
    uint64_t digits = 0;
    int count = 0;
    int shift = 0;
    int exponent = 0;
    bool is_fraction = false;
    at += *at == '-' || *at == '+';
    for (; (*at >= '0' && *at <= '9') || (*at == '.' && !is_fraction); at++) {
        if (*at == '.') {
            is_fraction = true;
            continue;
        }
        if (++count > 18)
            return false;
        digits = 10 * digits + (uint64_t)(*at - '0');
        shift -= is_fraction;
    }
    if (count == 0)
        return false;
    if (*at == 'e' || *at == 'E') {
        const bool is_down = at[1] == '-';
        at += at[1] == '-' || at[1] == '+' ? 2 : 1;
        if (*at < '0' || *at > '9')
            return false;
        for (; *at >= '0' && *at <= '9'; at++) {
            exponent = 10 * exponent + (*at - '0');
            if (exponent > 400)
                return false;
        }
        exponent = is_down ? -exponent : exponent;
    }
    shift += exponent;
    if (digits > UINT64_C(1) << 53 || shift < -22 || shift > 22)
        return false;
    const double value =
        shift < 0 ? (double)digits / powers[-shift] : (double)digits * powers[shift];
    *number = is_negative ? -value : value;
    *rest = at;
    return true;
}

sonject_status words_number(struct words *words, const char *what, double *number)
{
    const char *rest = words->at;
    if (!words_on_line(words))
        return words_failure(words, what);
    if (!read_short_number(words->at, &rest, number) && !text_to_number(words->at, number, &rest))
        return words_failure(words, what);
    if (!ends_word(*rest) || !isfinite(*number))
        return words_failure(words, what);
    words->at = rest;
    return SONJECT_OK;
}

sonject_status words_whole(struct words *words, const char *what, int64_t *number)
{
    if (!words_on_line(words))
        return words_failure(words, what);
    const char *at = words->at + (*words->at == '-' || *words->at == '+');
    int64_t value = 0;
    int digits = 0;
    for (; *at >= '0' && *at <= '9' && digits < 18; at++, digits++)
        value = 10 * value + (*at - '0');
    if (digits == 0 || !(ends_word(*at) || *at == '/'))
        return words_failure(words, what);
    *number = *words->at == '-' ? -value : value;
    words->at = at;
    return SONJECT_OK;
}
