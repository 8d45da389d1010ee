/* Samples in a file's types and order, and the same as images have them; and the arrays that a file
 * holds, of which one is wanted. */
#ifndef SONJECT_SWATH_SAMPLES_H
#define SONJECT_SWATH_SAMPLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"
#include "image/raster.h"

enum stored_type {
    STORED_INT8,
    STORED_UINT8,
    STORED_INT16,
    STORED_UINT16,
    STORED_INT32,
    STORED_UINT32,
    STORED_FLOAT32,
    STORED_FLOAT64
};

size_t stored_bytes(enum stored_type type);

/* Bytes of a float or double, whose bits stay as they are. */
double float_from_bytes(const unsigned char *bytes, size_t count, bool is_big_endian);

/* Where the samples of a part of an image are in memory, in the file's types and order. */
struct stored_samples {
    unsigned char *bytes[2];         /* the first sample of each channel */
    enum stored_type types[2];       /* of each channel */
    ptrdiff_t row_step, column_step; /* in samples */
    bool is_big_endian;
    bool are_amplitudes; /* numbers of whole types must not be negative */
    uint32_t largest;    /* more than this is not written; 0: the type's own */
};

/* Moves samples between a file's order and an image's: those of a part of region, whose pixels are
 * given row after row. writes: from the image to the file, where a number that is shown as the
 * float32 that is to be written keeps its bits; others of whole types are rounded. path: in
 * messages. Errors: INPUT (a sample that the other side cannot hold: says where). */
sonject_status samples_exchange(struct report *report, const char *path,
                                const struct raster_layout *layout,
                                const struct stored_samples *stored, const struct region *part,
                                const struct region *region, void *pixels, bool writes);

/* A number in another type, which holds it. */
void samples_convert(enum stored_type from_type, const unsigned char *from, enum stored_type type,
                     unsigned char *to, bool is_big_endian);

struct array_list {
    const char *wanted; /* NULL: the only one */
    unsigned matches;   /* arrays that are wanted */
    unsigned count;
    char text[600]; /* as messages list them */
};

/* Notes an array; true if it is wanted. is_image: it has several rows and columns of numbers that
 * sonject reads; others are wanted by their names alone, and not listed. */
bool array_list_add(struct array_list *list, const char *name, uint64_t rows, uint64_t columns,
                    bool is_image);

/* INPUT unless just one array is wanted. */
sonject_status array_list_check(struct report *report, const char *path,
                                const struct array_list *list);

#endif
