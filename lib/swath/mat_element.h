/* The building blocks of MATLAB files of version 5. */
#ifndef SONJECT_IO_MAT_ELEMENT_H
#define SONJECT_IO_MAT_ELEMENT_H

#include "swath/mat_file.h"

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

/* Bytes of a number of the type; 0 for others than numbers of up to 64 bits. */
size_t mat_type_bytes(uint32_t type);

/* How numbers of a class are stored when they are not packed; 0: sonject does not read it. */
uint32_t mat_type_of_class(uint32_t kind);

/* A number of the type, and back; those of whole types are in range. */
double mat_number(const unsigned char *bytes, uint32_t type, bool is_big_endian);
void mat_set_number(unsigned char *bytes, uint32_t type, bool is_big_endian, double number);

/* Takes the element that begins at *place of the bytes: *part gets where its data lie, *place what
 * follows. False if the bytes do not hold it. */
bool mat_take_element(const unsigned char *bytes, size_t count, bool is_big_endian, size_t *place,
                      struct mat_part *part);

/* Reads what a variable says of itself from the beginning of its element; of one that is not an
 * array of numbers in two dimensions, head is 0. */
void mat_read_head(const unsigned char *bytes, size_t count, bool is_big_endian,
                   struct mat_variable *variable);

/* Inflates the beginning of a variable: at most capacity bytes, *count gets how many. False if it
 * is damaged. */
bool mat_inflate(const unsigned char *compressed, size_t compressed_bytes, unsigned char *bytes,
                 size_t capacity, size_t *count);

/* The same bytes compressed, for free(); NULL if memory is out. */
unsigned char *mat_deflate(const unsigned char *bytes, size_t count, size_t *compressed_bytes);

/* False in builds without zlib. */
bool mat_can_inflate(void);

#endif
