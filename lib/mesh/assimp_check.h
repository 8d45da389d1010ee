/* A file on its way to Assimp, which believes what files say about their own sizes: what a file
 * makes it hold is to be in proportion to the file, and nothing is read beyond its end. */
#ifndef SONJECT_MESH_ASSIMP_CHECK_H
#define SONJECT_MESH_ASSIMP_CHECK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

struct suspect {
    struct report *report;
    const char *path;
    const char *bytes; /* goes to Assimp */
    size_t count;
    size_t binary; /* bytes of numbers behind a GLB's document */
    char *made;    /* bytes that take their place, owned; NULL: none */
};

/* The message "path: what". Returns INPUT. */
sonject_status suspect_refuse(const struct suspect *file, const char *what);

/* Whether a count is negative, or more than a file of its size can mean. */
bool suspect_is_too_many(const struct suspect *file, int64_t number);
sonject_status suspect_refuse_count(const struct suspect *file, const char *key);

/* Checks a glTF document and makes one of what is left of it: its shapes, whose lists lie within
 * their buffers, on nodes that form trees. *left is for free(). Errors: INPUT, MEMORY; *left is
 * then NULL. */
sonject_status check_gltf_text(const struct suspect *file, const char *text, size_t count,
                               char **left);

#endif
