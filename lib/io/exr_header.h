/* What the header of an OpenEXR file says of its pixels. */
#ifndef SONJECT_IO_EXR_HEADER_H
#define SONJECT_IO_EXR_HEADER_H

#include <stdbool.h>
#include <stdio.h>

#include "base/report.h"

struct exr_header {
    uint64_t bytes; /* of all of it, up to the table of the chunks' places */
    uint64_t rows, columns;
    int64_t first_row;    /* the number that the file gives it */
    uint64_t pixel_bytes; /* of all channels */
    unsigned compression; /* the file's number */
    uint64_t chunk_rows;  /* the last chunk may have fewer */
    bool is_upwards;      /* the last rows are stored first */
};

/* Reads the header of a file of so many bytes. Refuses (INPUT) what is damaged; tiles, several
 * parts, depths, compression that changes pixels, channels of fewer pixels than others, more than
 * 2^20 columns. path: for the message. */
sonject_status exr_header_read(struct report *report, const char *path, FILE *file,
                               uint64_t file_bytes, struct exr_header *header);

#endif
