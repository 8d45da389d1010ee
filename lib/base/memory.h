/* Allocation that cannot overflow. */
#ifndef SONJECT_BASE_MEMORY_H
#define SONJECT_BASE_MEMORY_H

#include <stdbool.h>
#include <stddef.h>

/* *product = a * b; false if that overflows (then *product is unchanged). */
bool size_multiply(size_t a, size_t b, size_t *product);

/* Zeroed memory for count elements of size bytes, to be given to free(). NULL if count * size
 * overflows or memory is out. count or size of 0 gives a valid pointer. */
void *allocate_array(size_t count, size_t size);

/* Whether less than half a gigabyte is to be had, which large libraries may need to be loaded. */
bool memory_is_short(void);

/* A copy of the terminated text, to be given to free(); NULL when memory is out. */
char *copy_text(const char *text);

#endif
