/* Numbers from text, the same under every locale, and texts fit for messages. */
#ifndef SONJECT_BASE_TEXT_H
#define SONJECT_BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Parses the decimal number that text starts with: sign, digits, '.', exponent; no hex, no nan;
 * "inf" and YAML's ".inf" are allowed. *rest points behind the number. Returns false if there is
 * none. The decimal separator is '.' under every locale. The result is correctly rounded, so a
 * number beyond the range of double is infinite. */
bool text_to_number(const char *text, double *number, const char **rest);

/* Parses a number times 10^shift, rounded once: "6.7" shifted by -2 is the double next to 0.067. */
bool text_to_shifted_number(const char *text, int shift, double *number, const char **rest);

/* Parses a whole text of decimal digits; false on anything else or overflow. */
bool text_to_count(const char *text, uint64_t *count);

/* Writes a finite number with so many significant digits, and '.' as separator under every locale.
 * capacity: at least digits + 10. Returns text. */
const char *text_of_number(char *text, size_t capacity, double number, int digits);

/* Puts '.' wherever the locale's decimal separator lies between two digits, for messages that are
 * kept in files. */
void text_use_points(char *text);

/* Returns whether text contains needle (may be empty), whatever the case of letters. */
bool contains_ignoring_case(const char *text, const char *needle);

/* Returns whether text is well-formed UTF-8 without control characters (U+0000 to U+001F, U+007F to
 * U+009F), line and paragraph separators (U+2028, U+2029) and characters that set the direction of
 * text (U+061C, U+200E, U+200F, U+202A to U+202E, U+2066 to U+2069). Names in scenes and campaigns
 * must be printable. */
bool text_is_printable(const char *text);

/* Returns whether text is well-formed UTF-8 and has characters beyond ASCII. */
bool text_is_beyond_ascii(const char *text);

/* Makes a text printable, as all text for a terminal must be. A space replaces each character below
 * U+0020, '?' each other one or byte. */
void text_make_printable(char *text);

/* Copies text for a message. A text that does not fit is cut between characters and ends in "...".
 * capacity: at least 4. Returns excerpt. */
const char *text_excerpt(char *excerpt, size_t capacity, const char *text);

/* ---- The word that a mistyped one was perhaps meant to be. */

struct nearest {
    const char *word;
    const char *best; /* NULL: nothing is near */
    size_t distance;
};

/* Up to a third of the letters, and one more, may be wrong. */
void nearest_begin(struct nearest *nearest, const char *word);
void nearest_consider(struct nearest *nearest, const char *candidate);

#endif
