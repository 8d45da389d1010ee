/* Arrays of MATLAB files of version 5 (.mat; -v6 and -v7 of MATLAB, scipy's and Octave's too):
 * two-dimensional, of double, single, uint8, uint16 or int16 numbers, real or (double, single)
 * complex. Rows and columns are MATLAB's. Copies differ from their source in the array's changed
 * numbers alone; all other variables keep every byte. A variable that is compressed, or whose
 * numbers MATLAB had packed into a smaller type than their own, is written anew. */
#ifndef SONJECT_IO_MAT_FILE_H
#define SONJECT_IO_MAT_FILE_H

#include <stdio.h>

#include <sonject/context.h>

#include "base/report.h"
#include "image/raster.h"

#define MAT_NAME_MAX 64 /* bytes, the final 0 among them */

/* Numbers of a variable: its real or imaginary part. */
struct mat_part {
    uint32_t type;           /* as they are stored */
    size_t tag, data, bytes; /* places in the variable's element */
};

/* Where a variable lies and what it is. */
struct mat_variable {
    uint64_t place, bytes; /* of its element in the file, the tag among them */
    bool is_compressed, is_complex;
    uint32_t kind; /* MATLAB's class */
    uint64_t rows, columns;
    size_t head; /* bytes of the element before its numbers; 0: it is no two-dimensional array */
    char name[MAT_NAME_MAX];
};

struct mat_file {
    FILE *file; /* owned */
    char *path; /* owned */
    uint64_t file_bytes;
    bool is_big_endian;
    struct mat_variable variable; /* that is read */
    struct raster_layout layout;
    unsigned char *element; /* owned: the variable, not compressed, its tag among it */
    size_t element_bytes;
    struct mat_part parts[2];
};

/* True if the file begins as such files do. */
bool mat_begins(const unsigned char *bytes, size_t count);

/* Opens an array by its name; NULL: the only one of more than one row and column. Refused (INPUT):
 * a damaged file, no such array or several (lists them), other types of numbers. On success to be
 * given to mat_file_close; on failure nothing is held. Errors: INPUT, STORAGE, MEMORY, UNSUPPORTED
 * (compressed in builds without zlib). */
sonject_status mat_file_open(struct report *report, const char *path, const char *array,
                             struct mat_file *file);
void mat_file_close(struct mat_file *file);

/* 32767 of int16, 0 of other types. */
uint32_t mat_file_largest(const struct mat_file *file);

/* Samples of a region, row after row. Errors: INPUT (a negative number where the type is of whole
 * numbers). */
sonject_status mat_file_read(struct report *report, const struct mat_file *file,
                             const struct region *region, void *pixels);

/* Writes at path a copy of the file with the region's samples replaced. A double whose value as a
 * float stays the same keeps all its bits. Published whole or not at all. Errors: INPUT, STORAGE,
 * MEMORY, CANCELLED. */
sonject_status mat_file_copy_with_patch(struct report *report, const struct mat_file *file,
                                        const char *path, const struct region *region,
                                        const void *pixels, sonject_progress_function progress,
                                        void *user);

#endif
