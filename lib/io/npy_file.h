/* NumPy arrays (.npy, versions 1 to 3): two-dimensional, rows in C order, of |u1, u2, f4
 * (amplitudes) or c8 (complex) in either byte order. */
#ifndef SONJECT_IO_NPY_FILE_H
#define SONJECT_IO_NPY_FILE_H

#include "io/sample_rows.h"

/* True if the file begins as such arrays do. */
bool npy_begins(const unsigned char *bytes, size_t count);

/* Refused (INPUT): other types (says which are read), Fortran order, other than two dimensions,
 * sizes that the file does not hold. On success rows is to be given to sample_rows_clear; on
 * failure nothing is held. Errors: INPUT, STORAGE, MEMORY. */
sonject_status npy_file_open(struct report *report, const char *path, struct sample_rows *rows);

#endif
