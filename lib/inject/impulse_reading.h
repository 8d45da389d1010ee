/* A file of impulses that is open; for impulse_reader.c (its head) and impulse_delivery.c (its
 * sets). */
#ifndef SONJECT_INJECT_IMPULSE_READING_H
#define SONJECT_INJECT_IMPULSE_READING_H

#include <hdf5.h>

#include "inject/impulse_file.h"

struct impulse_file {
    struct report *report;
    const char *path;
    hid_t file;
    struct impulse_head head;
};

/* "path: name what: trace again". Returns INPUT. */
sonject_status impulse_file_refuse(const struct impulse_file *file, const char *name,
                                   const char *what);

/* A group that the file has; negative if it has none, or something else of that name. */
hid_t impulse_group_open(hid_t file, const char *path);

#endif
