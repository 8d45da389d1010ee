/* The classes of a data set, numbered from 0 in the order in which they are first taken. */
#ifndef SONJECT_LABEL_CLASS_NAMES_H
#define SONJECT_LABEL_CLASS_NAMES_H

#include <stdint.h>

#include "base/report.h"

/* Starts as all zeros. */
struct class_names {
    char **names; /* owned */
    uint32_t count, capacity;
};

/* The number of the class of that name, which is new if there was none. Errors: MEMORY. */
sonject_status class_names_take(struct class_names *classes, struct report *report,
                                const char *name, uint32_t *number);

/* Writes them, one a line. Errors: STORAGE, MEMORY. */
sonject_status class_names_write(const struct class_names *classes, struct report *report,
                                 const char *path);
void class_names_clear(struct class_names *classes);

#endif
