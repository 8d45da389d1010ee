/* Names and numbers as files of text hold them, whatever the names and the process's locale. */
#ifndef SONJECT_LABEL_LABEL_TEXT_H
#define SONJECT_LABEL_LABEL_TEXT_H

#include "base/growing_text.h"

/* Twelve digits with a point; nothing for NaN and infinity. */
void label_text_number(struct growing_text *text, double value);

/* As XML's text: characters that mean something are escaped, those that XML forbids become '?'. */
void label_text_xml(struct growing_text *text, const char *words);

/* As a field of CSV: in quotes, which are doubled within. One that a spreadsheet would take for a
 * formula (it begins with = + - @, tab or carriage return) has a ' before it. */
void label_text_csv(struct growing_text *text, const char *words);

#endif
