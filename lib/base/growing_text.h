/* A text that grows as it is written. */
#ifndef SONJECT_BASE_GROWING_TEXT_H
#define SONJECT_BASE_GROWING_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/report.h"

/* Starts as all zeros. */
struct growing_text {
    char *characters; /* for free(); NULL while nothing is written */
    size_t length, capacity;
    bool failed; /* memory was out: the rest is not written */
};

void growing_text_add(struct growing_text *text, const char *format, ...) REPORT_FORMAT(2);

/* The text, for free(); NULL where memory was out. */
char *growing_text_end(struct growing_text *text);

/* Writes the text to a file, whole or not at all, and releases it. Errors: STORAGE, MEMORY (also
 * where it was out before). */
sonject_status growing_text_write(struct report *report, struct growing_text *text,
                                  const char *path);

#endif
