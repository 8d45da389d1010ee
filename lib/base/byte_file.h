/* Files read by place. */
#ifndef SONJECT_BASE_BYTE_FILE_H
#define SONJECT_BASE_BYTE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

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
