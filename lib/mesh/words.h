/* Words and numbers of a text file, with the line that they stand on. */
#ifndef SONJECT_MESH_WORDS_H
#define SONJECT_MESH_WORDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

struct words {
    struct report *report;
    const char *path;
    const char *at, *end; /* *end is 0 */
    size_t line;          /* of at, from 1 */
};

/* Skips blanks; a backslash before a line's end is one. True if a word follows on this line. */
bool words_on_line(struct words *words);

/* Skips blanks, line ends and, unless comment is 0, lines from that character on. True if a word
 * follows. */
bool words_left(struct words *words, char comment);
void words_skip_line(struct words *words);

/* Takes the word, in any case of letters, if it is next (words_left must be true). */
bool words_accept(struct words *words, const char *word);

/* "path, line n: expected <what>, found '<word>'". Returns INPUT. */
sonject_status words_failure(const struct words *words, const char *what);

/* A finite number / a whole number that makes up the next word; `what` for the message. A whole
 * number may end in '/'. Errors: INPUT. */
sonject_status words_number(struct words *words, const char *what, double *number);
sonject_status words_whole(struct words *words, const char *what, int64_t *number);

#endif
