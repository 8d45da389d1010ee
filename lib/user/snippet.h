/* Code of a shape that a user wrote in OpenCL C: what it must be before a compiler sees it, and how
 * its names are kept apart from those of other snippets and of the program around it. */
#ifndef SONJECT_USER_SNIPPET_H
#define SONJECT_USER_SNIPPET_H

#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

#define SNIPPET_BYTES_MAX ((size_t)64 * 1024)
#define SNIPPET_NAME_MAX  255 /* bytes */

struct user_snippet {
    char *name;          /* of its file, for messages; printable, without quotes and backslashes */
    char *code;          /* as the user wrote it */
    uint32_t first_line; /* number of the code's first line in that file */
    char *before; /* what stands before and behind it in a program: #line marks, and macros */
    char *behind; /* that rename its functions, types and variables */
};

/* Copies name and code, which become number `number` of a program. Refuses what could reach beyond
 * the snippet or hide from this check: directives other than #define, #error and conditions, names
 * of macros that start with two underscores, trigraphs and digraphs, brackets or conditions that do
 * not match (conditions must leave each branch's brackets matched), unfinished comments and texts,
 * control characters, and code without a function shape_distance or shape_normal. What is left for
 * the compiler to refuse. On failure nothing is held. Errors: INPUT ("name:line: what"), MEMORY. */
sonject_status snippet_make(struct report *report, const char *name, uint32_t first_line,
                            const char *code, uint32_t number, struct user_snippet *snippet);
void snippet_clear(struct user_snippet *snippet);

#endif
