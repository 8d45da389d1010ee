/* NumPy arrays (.npy, versions 1 to 3): two-dimensional, in C or Fortran order, of u1, u2, i2, u4,
 * i4, f4, f8 (amplitudes), c8 or c16 (complex) in either byte order. Numbers of 32 and 64 bits are
 * shown as float32. */
#ifndef SONJECT_IO_NPY_FILE_H
#define SONJECT_IO_NPY_FILE_H

#include "swath/sample_rows.h"

/* True if the file begins as such arrays do. */
bool npy_begins(const unsigned char *bytes, size_t count);

/* Refused (INPUT): other types (says which are read), other than two dimensions,
 * sizes that the file does not hold. On success rows is to be given to sample_rows_clear; on
 * failure nothing is held. Errors: INPUT, STORAGE, MEMORY. */
sonject_status npy_file_open(struct report *report, const char *path, struct sample_rows *rows);

#endif
