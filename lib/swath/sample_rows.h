/* Files whose rows are runs of plain samples at known places: channels of XTF files, NumPy arrays.
 * Copies differ from their source in the replaced samples alone, byte for byte; a double or a
 * 32-bit number whose value as a float stays the same keeps all its bits. */
#ifndef SONJECT_IO_SAMPLE_ROWS_H
#define SONJECT_IO_SAMPLE_ROWS_H

#include <stdio.h>

#include "base/report.h"
#include "image/raster.h"

/* What the file's numbers are where the image has them as float32. */
enum stored_number {
    STORED_AS_SHOWN, /* what the image's are */
    STORED_UINT32,   /* rounded to whole numbers */
    STORED_FLOAT64
};

struct sample_rows {
    FILE *file; /* owned; open for reading */
    char *path; /* owned */
    uint64_t file_bytes;
    struct raster_layout layout;
    uint64_t *places; /* owned: of each row's first stored sample; NULL: row_bytes apart */
    uint64_t first_place, row_bytes;
    enum stored_number stored;
    bool is_transposed; /* the file keeps columns together: they are what it calls rows */
    bool is_reversed;   /* column 0 is the row's last stored sample */
    bool is_big_endian;
    uint32_t largest;       /* larger samples are refused; 0: none are */
    bool above_is_negative; /* what is larger are negative numbers */
};

/* Opens a file and has its header read, which fills the rest of rows. On failure rows is cleared.
 * Errors: INPUT (it cannot be opened), MEMORY, and those of read_header. */
sonject_status sample_rows_open(struct report *report, const char *path,
                                sonject_status (*read_header)(struct report *report,
                                                              struct sample_rows *rows),
                                struct sample_rows *rows);

/* Frees what rows owns; fit for zeroed ones. */
void sample_rows_clear(struct sample_rows *rows);

/* Reads a region's samples in the machine's byte order, row after row. Errors: INPUT (cut short, a
 * sample that the image cannot hold), MEMORY. */
sonject_status sample_rows_read(struct report *report, const struct sample_rows *rows,
                                const struct region *region, void *pixels);

/* Writes at path a copy of the file with the region's samples replaced. path is published whole or
 * not at all. progress may be NULL. Errors: INPUT (cut short, a new sample that the file cannot
 * hold), STORAGE, MEMORY, CANCELLED. */
sonject_status sample_rows_copy_with_patch(struct report *report, const struct sample_rows *rows,
                                           const char *path, const struct region *region,
                                           const void *pixels, sonject_progress_function progress,
                                           void *user);

#endif
