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

/* How many lines end in the text. */
unsigned long text_count_lines(const char *text);

/* True if the text is well-formed UTF-8 without control characters. */
bool text_is_printable(const char *text);

/* Copies text for use in a message; where it does not fit it is cut between characters and ends in
 * "...". capacity: at least 4. Returns excerpt. */
const char *text_excerpt(char *excerpt, size_t capacity, const char *text);

#endif
