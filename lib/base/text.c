#include "base/text.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A number halfway between two doubles has at most 767 significant digits. Of further digits it
 * only matters whether any is not 0. */
#define DIGITS_KEPT 780

/* A limit far beyond any exponent that matters, and far from overflow when lengths are added. */
#define EXPONENT_LIMIT INT64_C(1000000000000000)

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Copies digits with at most one '.', but without the '.' and leading zeros. *exponent gets the
 * power of ten of the last digit. Returns what follows; NULL if there is no digit. */
static const char *take_digits(const char *text, char digits[DIGITS_KEPT + 2], int64_t *exponent)
{
    size_t count = 0;
    bool has_digit = false;
    bool is_fraction = false;
    bool has_more = false; /* a digit other than 0 was dropped */
    for (; is_digit(*text) || (*text == '.' && !is_fraction); text++) {
        if (*text == '.') {
            is_fraction = true;
            continue;
        }
        const bool is_dropped = count == DIGITS_KEPT;
        has_digit = true;
        has_more = has_more || (is_dropped && *text != '0');
        *exponent += is_dropped ? !is_fraction : -is_fraction;
        if (!is_dropped && (count > 0 || *text != '0'))
            digits[count++] = *text;
    }
    if (has_more) {
        digits[count++] = '1';
        --*exponent;
    }
    digits[count] = '\0';
    return has_digit ? text : NULL;
}

/* Adds a written exponent, if there is one. Returns the text that follows. */
static const char *take_exponent(const char *text, int64_t *exponent)
{
    const char *digit = text + 1;
    if (*text != 'e' && *text != 'E')
        return text;
    const bool is_negative = *digit == '-';
    digit += *digit == '-' || *digit == '+';
    if (!is_digit(*digit))
        return text;
    int64_t written = 0;
    for (; is_digit(*digit); digit++)
        if (written < EXPONENT_LIMIT)
            written = 10 * written + (*digit - '0');
    *exponent += is_negative ? -written : written;
    return digit;
}

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

static const char *skip_infinity(const char *text)
{
    text += *text == '.';
    for (const char *letter = "inf"; *letter; letter++, text++)
        if (lower(*text) != *letter)
            return NULL;
    return text;
}

bool text_to_shifted_number(const char *text, int shift, double *number, const char **rest)
{
    char digits[DIGITS_KEPT + 2];
    char whole[DIGITS_KEPT + 40];
    int64_t exponent = shift;
    const bool is_negative = *text == '-';
    text += *text == '-' || *text == '+';
    const char *end = skip_infinity(text);
    if (end) {
        *number = is_negative ? -HUGE_VAL : HUGE_VAL;
        *rest = end;
        return true;
    }
    end = take_digits(text, digits, &exponent);
    if (!end)
        return false;
    *rest = take_exponent(end, &exponent);
    /* without a decimal separator, so that strtod reads the same under every locale */
    snprintf(whole, sizeof whole, "%s%se%d", is_negative ? "-" : "", *digits ? digits : "0",
             (int)(exponent > 100000    ? 100000
                   : exponent < -100000 ? -100000
                                        : exponent));
    *number = strtod(whole, NULL);
    return true;
}

bool text_to_number(const char *text, double *number, const char **rest)
{
    return text_to_shifted_number(text, 0, number, rest);
}

const char *text_of_number(char *text, size_t capacity, double number, int digits)
{
    size_t length = 0;
    snprintf(text, capacity, "%.*g", digits, number);
    for (const char *from = text; *from; from++) {
        if (is_digit(*from) || strchr("+-e", *from))
            text[length++] = *from;
        else if (length == 0 || text[length - 1] != '.') /* a locale's may be several bytes */
            text[length++] = '.';
    }
    text[length] = 0;
    return text;
}

void text_use_points(char *text)
{
    char half[24];
    char *to = text;
    snprintf(half, sizeof half, "%.1f", 0.5); /* '0', the separator, '5' */
    const size_t length = strlen(half) - 2;
    for (const char *from = text; *from; to++) {
        const bool is_separator = from > text && is_digit(from[-1]) &&
                                  strncmp(from, half + 1, length) == 0 && is_digit(from[length]);
        *to = is_separator ? '.' : *from;
        from += is_separator ? length : 1;
    }
    *to = 0;
}

bool text_to_count(const char *text, uint64_t *count)
{
    uint64_t value = 0;
    if (!*text)
        return false;
    for (; *text; text++) {
        if (!is_digit(*text))
            return false;
        const uint64_t digit = (uint64_t)(*text - '0');
        if (value > (UINT64_MAX - digit) / 10)
            return false;
        value = 10 * value + digit;
    }
    *count = value;
    return true;
}

bool contains_ignoring_case(const char *text, const char *needle)
{
    for (; *text; text++) {
        size_t i = 0;
        while (needle[i] && tolower((unsigned char)text[i]) == tolower((unsigned char)needle[i]))
            i++;
        if (!needle[i])
            return true;
    }
    return needle[0] == '\0';
}

/* Returns the bytes of the well-formed UTF-8 character at the start of text; 0 if there is none.
 * Well-formed: in the shortest form, no surrogate, not above U+10FFFF. */
static size_t character_length(const unsigned char *text)
{
    const unsigned char first = text[0];
    if (first < 0x80)
        return first != 0;
    const size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
    unsigned char low = 0x80;
    unsigned char high = 0xBF;
    if (first < 0xC2 || first > 0xF4)
        return 0;
    if (first == 0xE0)
        low = 0xA0;
    else if (first == 0xF0)
        low = 0x90;
    else if (first == 0xED)
        high = 0x9F;
    else if (first == 0xF4)
        high = 0x8F;
    for (size_t i = 1; i < length; i++) {
        if (text[i] < low || text[i] > high)
            return 0;
        low = 0x80;
        high = 0xBF;
    }
    return length;
}

/* Returns whether a well-formed character is a control (C0, DEL, C1), ends a line or paragraph, or
 * changes the direction of later text. Such changes can make a line read as another. */
static bool is_control(const unsigned char *byte)
{
    if (byte[0] < 0x20 || byte[0] == 0x7F)
        return true;
    if (byte[0] == 0xC2)
        return byte[1] < 0xA0; /* U+0080 to U+009F */
    if (byte[0] == 0xD8)
        return byte[1] == 0x9C; /* U+061C */
    if (byte[0] != 0xE2)
        return false;
    return byte[1] == 0x80
               ? byte[2] == 0x8E || byte[2] == 0x8F || (byte[2] >= 0xA8 && byte[2] <= 0xAE)
               : byte[1] == 0x81 && byte[2] >= 0xA6 && byte[2] <= 0xA9;
}

bool text_is_printable(const char *text)
{
    const unsigned char *byte = (const unsigned char *)text;
    while (*byte) {
        const size_t length = character_length(byte);
        if (length == 0 || is_control(byte))
            return false;
        byte += length;
    }
    return true;
}

bool text_is_beyond_ascii(const char *text)
{
    const unsigned char *byte = (const unsigned char *)text;
    bool is_beyond = false;
    for (size_t length; *byte; byte += length) {
        length = character_length(byte);
        if (length == 0)
            return false;
        is_beyond = is_beyond || length > 1;
    }
    return is_beyond;
}

void text_make_printable(char *text)
{
    const unsigned char *byte = (const unsigned char *)text;
    while (*byte) {
        const size_t length = character_length(byte);
        if (length == 0 || is_control(byte)) {
            *text++ = *byte < 0x20 ? ' ' : '?';
            byte += length > 0 ? length : 1;
            continue;
        }
        for (size_t i = 0; i < length; i++)
            *text++ = (char)*byte++;
    }
    *text = '\0';
}

const char *text_excerpt(char *excerpt, size_t capacity, const char *text)
{
    const size_t length = strlen(text);
    if (length < capacity) {
        memcpy(excerpt, text, length + 1);
        return excerpt;
    }
    size_t kept = capacity - 4;
    while (kept > 0 && ((unsigned char)text[kept] & 0xC0) == 0x80)
        kept--;
    memcpy(excerpt, text, kept);
    memcpy(excerpt + kept, "...", 4);
    return excerpt;
}

/* ---- "Did you mean". */

#define WORD_MAX 64 /* letters; longer words are near to nothing */

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Returns the optimal string alignment distance: the insertions, deletions, replacements and swaps
 * of neighbours that turn a into b. */
static size_t edit_distance(const char *a, const char *b)
{
    size_t rows[3][WORD_MAX + 1];
    size_t *before = rows[0];
    size_t *last = rows[1];
    size_t *now = rows[2];
    const size_t columns = strlen(b);
    if (columns > WORD_MAX || strlen(a) > WORD_MAX)
        return SIZE_MAX;
    for (size_t j = 0; j <= columns; j++)
        last[j] = j;
    for (size_t i = 1; a[i - 1]; i++) {
        now[0] = i;
        for (size_t j = 1; j <= columns; j++) {
            const size_t changed = last[j - 1] + (a[i - 1] != b[j - 1]);
            now[j] = least(changed, least(last[j], now[j - 1]) + 1);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                now[j] = least(now[j], before[j - 2] + 1);
        }
        size_t *spare = before;
        before = last;
        last = now;
        now = spare;
    }
    return last[columns];
}

void nearest_begin(struct nearest *nearest, const char *word)
{
    nearest->word = word;
    nearest->best = NULL;
    nearest->distance = strlen(word) / 3 + 2; /* near words are nearer than this */
}

void nearest_consider(struct nearest *nearest, const char *candidate)
{
    const size_t distance = edit_distance(nearest->word, candidate);
    if (distance < nearest->distance && distance < strlen(candidate)) {
        nearest->best = candidate;
        nearest->distance = distance;
    }
}
