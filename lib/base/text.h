/* Numbers from text, the same under every locale, and texts fit for messages. */
#ifndef SONJECT_BASE_TEXT_H
#define SONJECT_BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Parses the decimal number that text starts with (sign, digits, '.', exponent; no hex, no nan;
 * "inf" and ".inf" as YAML writes it are allowed). *rest points behind it. False if there is none.
 * The decimal separator is '.', whatever the process's locale; correctly rounded, so a number
 * beyond the range of double is infinite. */
bool text_to_number(const char *text, double *number, const char **rest);

/* The same times 10^shift, rounded once: "6.7" shifted by -2 is the double nearest to 0.067. */
bool text_to_shifted_number(const char *text, int shift, double *number, const char **rest);

/* Parses a whole text of decimal digits; false on anything else or overflow. */
bool text_to_count(const char *text, uint64_t *count);

/* Writes a finite number with so many significant digits, the separator a '.' under every locale.
 * capacity: at least digits + 10. Returns text. */
const char *text_of_number(char *text, size_t capacity, double number, int digits);

/* Whether a needle, empty or not, is in the text, whatever the case of its letters. */
bool contains_ignoring_case(const char *text, const char *needle);

/* True if the text is well-formed UTF-8 without control characters (U+0000 to U+001F, U+007F to
 * U+009F), line and paragraph separators (U+2028, U+2029) and those that set the direction of text
 * (U+061C, U+200E, U+200F, U+202A to U+202E, U+2066 to U+2069). Names in scenes and campaigns must
 * be such. */
bool text_is_printable(const char *text);

/* Makes a text so, as all that goes to a terminal is made: '?' for each other character or byte, a
 * space below U+0020. */
void text_make_printable(char *text);

/* Copies text for use in a message; where it does not fit it is cut between characters and ends in
 * "...". capacity: at least 4. Returns excerpt. */
const char *text_excerpt(char *excerpt, size_t capacity, const char *text);

/* ---- What a mistyped word was perhaps meant to be. */

struct nearest {
    const char *word;
    const char *best; /* NULL: nothing is near */
    size_t distance;
};

/* A third of the letters may be wrong, and one at least. */
void nearest_begin(struct nearest *nearest, const char *word);
void nearest_consider(struct nearest *nearest, const char *candidate);

#endif
