/* The directories of a TIFF or BigTIFF file: which tags there are, and their values. */
#ifndef SONJECT_IO_TIFF_TAGS_H
#define SONJECT_IO_TIFF_TAGS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/report.h"

enum tag_name {
    TAG_KIND, /* bit 0: a reduced copy of another page */
    TAG_WIDTH,
    TAG_LENGTH,
    TAG_BITS,
    TAG_COMPRESSION,
    TAG_PHOTOMETRIC,
    TAG_FILL_ORDER,
    TAG_STRIP_OFFSETS,
    TAG_CHANNELS,
    TAG_ROWS_PER_STRIP,
    TAG_STRIP_COUNTS,
    TAG_PLANES,
    TAG_PREDICTOR,
    TAG_TILE_WIDTH,
    TAG_TILE_LENGTH,
    TAG_TILE_OFFSETS,
    TAG_TILE_COUNTS,
    TAG_SUBPAGES,
    TAG_EXTRA_CHANNELS,
    TAG_SAMPLE_FORMAT,
    TAG_TOTAL
};

struct tag {
    uint64_t count;         /* 0: not there */
    size_t size;            /* of a value: 1, 2, 4 or 8 bytes */
    uint64_t entry, values; /* places */
};

struct tiff_reader {
    struct report *report;
    const char *path;
    FILE *file;
    uint64_t file_bytes;
    bool is_big, is_big_endian;
    struct tag tags[TAG_TOTAL]; /* of the directory read last */
};

/* Opens path. On failure nothing is left to close. Errors: STORAGE. */
sonject_status tiff_reader_open(struct report *report, const char *path,
                                struct tiff_reader *reader);
void tiff_reader_close(struct tiff_reader *reader);

/* The message for a file that breaks the format's rules. Returns INPUT. */
sonject_status tiff_damaged(const struct tiff_reader *reader, const char *how);

/* False if the file does not hold as much. */
bool tiff_read_at(const struct tiff_reader *reader, uint64_t place, void *bytes, size_t count);

/* Reads the file's head; *first gets the place of the first directory. Errors: INPUT. */
sonject_status tiff_read_header(struct tiff_reader *reader, uint64_t *first);

/* Reads a directory into the reader's tags; *next gets the place of the next one, 0 after the last.
 * False if it is broken or cut short. */
bool tiff_read_directory(struct tiff_reader *reader, uint64_t place, uint64_t *next);

/* A tag's first value, or what holds if the tag is not there; false if it cannot be read. */
bool tiff_tag_value(const struct tiff_reader *reader, enum tag_name name, uint64_t otherwise,
                    uint64_t *value);

/* The same of a tag with a value for each of one or two channels: false if these differ too. */
bool tiff_tag_common_value(const struct tiff_reader *reader, enum tag_name name, uint64_t otherwise,
                           uint64_t *value);

/* Bytes that a place takes in this file: 4, or 8 in a BigTIFF. */
size_t tiff_place_bytes(const struct tiff_reader *reader);

#endif
