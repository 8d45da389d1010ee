/* Grey BMP images of 8 bits: uncompressed, with a palette of the 256 grey levels in order. */
#ifndef SONJECT_IO_BMP_FILE_H
#define SONJECT_IO_BMP_FILE_H

#include "io/sample_rows.h"

/* True if the file begins as BMP does. */
bool bmp_begins(const unsigned char *bytes, size_t count);

/* Refused (INPUT): headers that are damaged, colours, other depths, compression, a file that is cut
 * short. On success rows is to be given to sample_rows_clear; on failure nothing is held. Errors:
 * INPUT, STORAGE, MEMORY. */
sonject_status bmp_file_open(struct report *report, const char *path, struct sample_rows *rows);

#endif
