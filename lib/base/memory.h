/* Allocation that cannot overflow, and texts that grow as they are written. */
#ifndef SONJECT_BASE_MEMORY_H
#define SONJECT_BASE_MEMORY_H

#include <stdbool.h>
#include <stddef.h>

#include "base/report.h"

/* The number of an array's elements. */
#define COUNT(list) (sizeof(list) / sizeof(list)[0])

/* Sets *product = a * b. Returns false, with *product unchanged, if that overflows. */
bool size_multiply(size_t a, size_t b, size_t *product);

/* Returns zeroed memory for count elements of size bytes, for free(). NULL if count * size
 * overflows or memory is out. If count or size is 0, the pointer is valid. */
void *allocate_array(size_t count, size_t size);

/* Makes room for one more element of size bytes behind count elements of a list that only this
 * function grows: room doubles when full. NULL if out of memory; the list then stays as it was. */
void *grow_doubling(void *list, size_t count, size_t size);

/* Grows *list, which only this function and grow_doubling grow, from count elements of size bytes
 * by one of zeros. what: see report_out_of_memory. Errors: MEMORY. */
sonject_status grow_list(struct report *report, void *list, size_t count, size_t size,
                         const char *what);

/* Returns whether less than half a gigabyte is left, which loading a large library may need. */
bool memory_is_short(void);

/* Returns a copy of the terminated text, for free(); NULL if out of memory. */
char *copy_text(const char *text);

/* A text that grows. All zeros at the start. */
struct growing_text {
    char *characters; /* for free(); NULL while nothing is written */
    size_t length, capacity;
    bool failed; /* memory was out; the rest is missing */
};

void growing_text_add(struct growing_text *text, const char *format, ...) REPORT_FORMAT(2);

/* Returns the text, for free(); NULL if memory was out. */
char *growing_text_end(struct growing_text *text);

/* Compares for qsort, the smallest first. */
int compare_doubles(const void *a, const void *b);

#endif
