/* Grey images of the Netpbm family: PGM (P5, 8 or 16 bits) and PFM (Pf, 32-bit floating point, of
 * either byte order, the last row first). */
#ifndef SONJECT_IO_PNM_FILE_H
#define SONJECT_IO_PNM_FILE_H

#include "io/sample_rows.h"

/* True if the file begins as such images do. */
bool pnm_begins(const unsigned char *bytes, size_t count);

/* Refused (INPUT): headers that are damaged, sizes that the file does not hold, a PFM whose numbers
 * are scaled. On success rows is to be given to sample_rows_clear; on failure nothing is held.
 * Errors: INPUT, STORAGE, MEMORY. */
sonject_status pnm_file_open(struct report *report, const char *path, struct sample_rows *rows);

/* The text that a comment line "# name=value" of the header holds, copied into value; false if
 * there is none of that name or it does not fit. */
bool pnm_file_attribute(const struct sample_rows *rows, const char *name, char *value,
                        size_t capacity);

#endif
