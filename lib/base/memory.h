/* Allocation that cannot overflow, and texts that grow as they are written. */
#ifndef SONJECT_BASE_MEMORY_H
#define SONJECT_BASE_MEMORY_H

#include <stdbool.h>
#include <stddef.h>

#include "base/report.h"

/* Elements of an array. */
#define COUNT(list) (sizeof(list) / sizeof(list)[0])

/* *product = a * b; false if that overflows (then *product is unchanged). */
bool size_multiply(size_t a, size_t b, size_t *product);

/* Zeroed memory for count elements of size bytes, to be given to free(). NULL if count * size
 * overflows or memory is out. count or size of 0 gives a valid pointer. */
void *allocate_array(size_t count, size_t size);

/* Room for one more element of size bytes behind count ones of a list that has grown by this alone:
 * room doubles when it is full. NULL where memory is out: then the list stays as it was. */
void *grow_doubling(void *list, size_t count, size_t size);

/* Whether less than half a gigabyte is to be had, which large libraries may need to be loaded. */
bool memory_is_short(void);

/* A copy of the terminated text, to be given to free(); NULL when memory is out. */
char *copy_text(const char *text);

/* A text that grows; starts as all zeros. */
struct growing_text {
    char *characters; /* for free(); NULL while nothing is written */
    size_t length, capacity;
    bool failed; /* memory was out: the rest is not written */
};

void growing_text_add(struct growing_text *text, const char *format, ...) REPORT_FORMAT(2);

/* The text, for free(); NULL where memory was out. */
char *growing_text_end(struct growing_text *text);

/* For qsort: the smallest first. */
int compare_doubles(const void *a, const void *b);

#endif
