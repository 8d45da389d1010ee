/* Images of FITS files: the two-dimensional array of the first part, of unsigned 8-bit, signed or
 * unsigned 16-bit numbers or 32-bit floating point. Rows are the second index, in the file's order.
 */
#ifndef SONJECT_IO_FITS_FILE_H
#define SONJECT_IO_FITS_FILE_H

#include "io/sample_rows.h"

/* True if the file begins as FITS does. */
bool fits_begins(const unsigned char *bytes, size_t count);

/* Refused (INPUT): headers that are damaged, arrays of other types or dimensions, scaled numbers, a
 * file that is cut short. On success rows is to be given to sample_rows_clear; on failure nothing
 * is held. Errors: INPUT, STORAGE, MEMORY. */
sonject_status fits_file_open(struct report *report, const char *path, struct sample_rows *rows);

#endif
