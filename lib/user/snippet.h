/* Code of a shape that a user wrote in OpenCL C, a translation unit of its own: what it must be
 * before a compiler sees it. */
#ifndef SONJECT_USER_SNIPPET_H
#define SONJECT_USER_SNIPPET_H

#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

#define SNIPPET_BYTES_MAX ((size_t)64 * 1024)
#define SNIPPET_NAME_MAX  255 /* bytes */

struct user_snippet {
    char *name;          /* of its file, for messages */
    char *code;          /* as the user wrote it */
    uint32_t first_line; /* number of the code's first line in that file */
};

/* Pragmas that hold for a snippet. clang keeps its names out of the linker's sight. */
#define SNIPPET_OWN_NAMES                                                                          \
    "#pragma clang attribute push(__attribute__((internal_linkage)), apply_to = function)\n"       \
    "#pragma clang attribute push(__attribute__((internal_linkage)), "                             \
    "apply_to = variable(is_global))\n"
#define SNIPPET_NAMES_END "#pragma clang attribute pop\n#pragma clang attribute pop\n"

/* What stands before and behind a snippet, with its number, twice, as %lu. A kernel calls the
 * functions here, which are written before any macro of the snippet's. */
#define SNIPPET_BEFORE                                                                             \
    "#pragma OPENCL FP_CONTRACT OFF\n"                                                             \
    "#ifdef __clang__\n"                                                                           \
    "#pragma clang diagnostic ignored \"-Wpragma-clang-attribute\"\n"                              \
    "#pragma clang diagnostic error \"-Wundefined-internal\"\n" SNIPPET_OWN_NAMES "#endif\n"       \
    "static float shape_distance(float3, float3, float, const float *);\n"                         \
    "static float3 shape_normal(float3, const float *);\n"                                         \
    "#ifdef __clang__\n" SNIPPET_NAMES_END "#endif\n"                                              \
    "float user_%lu_distance(float3 p, float3 d, float t, const float *a)\n"                       \
    "{ return shape_distance(p, d, t, a); }\n"                                                     \
    "float3 user_%lu_normal(float3 p, const float *a) { return shape_normal(p, a); }\n"            \
    "#ifdef __clang__\n" SNIPPET_OWN_NAMES "#endif\n"
#define SNIPPET_BEHIND "\n\n#ifdef __clang__\n" SNIPPET_NAMES_END "#endif\n"

/* Copies name and code. Refuses what reaches beyond the snippet: directives other than #define,
 * #error and conditions, _Pragma, trigraphs, a # in disguise, control characters, and code without
 * a function shape_distance or shape_normal. What is left for the compiler to refuse. On failure
 * nothing is held. Errors: INPUT ("name:line: what"), MEMORY. */
sonject_status snippet_make(struct report *report, const char *name, uint32_t first_line,
                            const char *code, struct user_snippet *snippet);
void snippet_clear(struct user_snippet *snippet);

#endif
