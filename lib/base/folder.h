/* The names in a folder. */
#ifndef SONJECT_BASE_FOLDER_H
#define SONJECT_BASE_FOLDER_H

#include <stddef.h>

#include "base/report.h"

struct folder_names {
    char **names; /* owned; sorted */
    size_t count;
};

/* Lists what begins with prefix, "." and ".." left out; nothing where there is no such folder. On
 * success to be given to folder_names_clear; on failure nothing is held. Errors: STORAGE, MEMORY
 * (of more than a million names, too). */
sonject_status folder_names_read(struct folder_names *list, struct report *report, const char *path,
                                 const char *prefix);
void folder_names_clear(struct folder_names *list);

#endif
