/* Mesh files of all formats that are read, as bytes in memory, to be damaged. */
#ifndef SONJECT_TESTS_MESH_DRAFTS_H
#define SONJECT_TESTS_MESH_DRAFTS_H

#include <stddef.h>

#include "kernel/mesh_samples.h"

/* A text or bytes that grow. */
struct draft {
    char *bytes;
    size_t count, capacity;
};

enum format {
    STL_TEXT,
    STL_BINARY,
    OBJ,
    PLY_AS_TEXT,
    PLY_LITTLE,
    PLY_BIG,
    FORMATS
};

/* A file name for each. */
extern const char *const draft_names[];

/* The sample in a format; to be given to clear_draft. */
struct draft write_format(enum format format, const struct mesh_sample *sample);
void clear_draft(struct draft *draft);

/* Appends; a 0 byte follows that does not count. */
void put(struct draft *draft, const void *bytes, size_t count);
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void put_text(struct draft *draft, const char *format, ...);

#endif
