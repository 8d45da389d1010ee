/* A file of impulses that is open; for impulse_reader.c (its head) and impulse_delivery.c (its
 * sets). */
#ifndef SONJECT_INJECT_IMPULSE_READING_H
#define SONJECT_INJECT_IMPULSE_READING_H

#include "inject/impulse_file.h"
#include "io/decoder.h"

struct impulse_file {
    struct report *report;
    struct decoder_file file;
    sonject_status failure; /* of the system, in the middle of a read; else OK */
    struct impulse_head head;
};

/* "path: name what: trace again"; returns INPUT. Or what the system failed with. */
sonject_status impulse_file_refuse(const struct impulse_file *file, const char *name,
                                   const char *what);

/* Asks the decoder (io/decoder.h) about a part of a group. */
bool impulse_file_ask(struct impulse_file *file, enum decoder_function function, const char *group,
                      const char *name, const struct region *region, struct decoder_reply *reply,
                      struct decoder_bytes *out);

bool impulse_file_integer(struct impulse_file *file, const char *group, const char *name,
                          int64_t low, int64_t high, int32_t *value);

#endif
