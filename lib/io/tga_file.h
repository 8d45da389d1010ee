/* Grey Targa images of 8 bits, stored plainly. */
#ifndef SONJECT_IO_TGA_FILE_H
#define SONJECT_IO_TGA_FILE_H

#include "io/sample_rows.h"

#define TGA_HEAD_BYTES 18

/* True if the file begins as Targa does. It has no mark of its own: this goes by what the fields of
 * its head may hold, so other formats are to be tried before. */
bool tga_begins(const unsigned char *bytes, size_t count);

/* Refused (INPUT): colours, palettes, transparency, other depths, run-length coding, a file that is
 * cut short. On success rows is to be given to sample_rows_clear; on failure nothing is held.
 * Errors: INPUT, STORAGE, MEMORY. */
sonject_status tga_file_open(struct report *report, const char *path, struct sample_rows *rows);

#endif
