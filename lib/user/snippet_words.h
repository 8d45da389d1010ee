/* The words of a snippet that its neighbours must not see: what it declares outside of functions,
 * and its macros. */
#ifndef SONJECT_USER_SNIPPET_WORDS_H
#define SONJECT_USER_SNIPPET_WORDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

struct word {
    size_t start, length; /* in the code */
};

struct words {
    struct word *words; /* owned */
    size_t count, capacity;
};

struct snippet_words {
    struct words names;  /* functions, variables, types */
    struct words macros; /* that it defines */
};

/* Reads the code as a compiler's first passes would, and refuses what snippet_make says. On failure
 * nothing is held. Errors: INPUT, MEMORY. */
sonject_status snippet_words_read(struct report *report, const char *name, uint32_t first_line,
                                  const char *code, struct snippet_words *words);
void snippet_words_clear(struct snippet_words *words);

/* Whether one of the words is `text`. */
bool words_hold(const struct words *words, const char *code, const char *text);

#endif
