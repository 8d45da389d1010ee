/* A snippet without its comments, texts and spliced lines. */
#ifndef SONJECT_USER_SNIPPET_PLAIN_H
#define SONJECT_USER_SNIPPET_PLAIN_H

#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

#define SPLICED_LINE '\v' /* the end of a line that a backslash joins to the next one */

/* A copy in which spaces stand for comments and for what is in quotes, SPLICED_LINE for line ends
 * that do not end a directive; each character keeps its place and its line. *plain is for free(),
 * NULL on failure. Errors: INPUT ("name:line: what": characters that no snippet needs, unfinished
 * comments and texts), MEMORY. */
sonject_status snippet_plain(struct report *report, const char *name, uint32_t first_line,
                             const char *code, char **plain);

#endif
