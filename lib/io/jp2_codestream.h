/* The coded image within a JPEG 2000 file: what its markers say, and whether it is whole. */
#ifndef SONJECT_IO_JP2_CODESTREAM_H
#define SONJECT_IO_JP2_CODESTREAM_H

#include <stdio.h>

#include "base/report.h"
#include "io/byte_file.h"

/* Rows and columns: the encoder halves each image five times. */
#define JP2_SIDE_MIN 32

struct jp2_image {
    uint64_t rows, columns;
    unsigned bits; /* of a sample, which is unsigned */
};

/* True if bytes of a file begin as a coded image does. */
bool jp2_codestream_begins(const unsigned char *bytes, size_t count);

/* Checks the coded image in that part of the file, before a decoder believes what it says: one
 * component of 8 or 16 bit unsigned, no more pixels than so many bytes hold and than are decoded
 * at once, tiles that all are there with all their parts, one behind the other up to the end, and
 * no more blocks, layers and precincts than memory may be taken for. Errors: INPUT, MEMORY. path:
 * for the message. */
sonject_status jp2_codestream_check(struct report *report, const char *path, FILE *file,
                                    const struct byte_range *part, struct jp2_image *image);

#endif
