/* Files read by place, and choices of their parts. */
#ifndef SONJECT_IO_BYTE_FILE_H
#define SONJECT_IO_BYTE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Parts of a file, one after the other. */
struct byte_range {
    uint64_t place, count;
};

struct byte_ranges {
    struct byte_range *list; /* to be given to free() */
    size_t count, capacity;
};

/* Adds a part that follows those that are there. False when memory is out. */
bool byte_ranges_add(struct byte_ranges *ranges, uint64_t place, uint64_t count);

/* Opens for reading; NULL with errno, as file_open, if that fails. */
FILE *byte_file_open(const char *path, uint64_t *bytes);

/* False if the file does not hold as much. */
bool byte_file_read(FILE *file, uint64_t place, void *bytes, size_t count);

/* Copies count bytes of from to where to stands; false if reading or writing fails. */
bool byte_file_copy(FILE *from, uint64_t place, uint64_t count, FILE *to);

#ifdef __cplusplus
}
#endif

#endif
