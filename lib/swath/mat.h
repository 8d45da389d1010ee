/* What MATLAB files of version 5 are built of. */
#ifndef SONJECT_SWATH_MAT_H
#define SONJECT_SWATH_MAT_H

#include <stdbool.h>
#include <stddef.h>

#define MAT_TAG 8 /* bytes of a tag */

/* Types of elements and stored numbers, as the format numbers them. */
enum mat_type {
    MAT_INT8 = 1,
    MAT_UINT8 = 2,
    MAT_INT16 = 3,
    MAT_UINT16 = 4,
    MAT_INT32 = 5,
    MAT_UINT32 = 6,
    MAT_SINGLE = 7,
    MAT_DOUBLE = 9,
    MAT_MATRIX = 14,
    MAT_COMPRESSED = 15
};

/* MATLAB's classes of variables. */
enum mat_class {
    MAT_CLASS_DOUBLE = 6,
    MAT_CLASS_SINGLE = 7,
    MAT_CLASS_UINT8 = 9,
    MAT_CLASS_INT16 = 10,
    MAT_CLASS_UINT16 = 11,
    MAT_CLASS_LAST_NUMERIC = 15
};

/* Inflates the beginning of a variable: at most capacity bytes, *count gets how many. False if it
 * is damaged. */
bool mat_inflate(const unsigned char *compressed, size_t compressed_bytes, unsigned char *bytes,
                 size_t capacity, size_t *count);

/* The same bytes compressed, for free(); NULL if memory is out. */
unsigned char *mat_deflate(const unsigned char *bytes, size_t count, size_t *compressed_bytes);

/* False in builds without zlib, where the two above fail. */
bool mat_can_inflate(void);

#endif
