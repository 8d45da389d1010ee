/* Drafts of small files of every format that holds a swath. Include this header first. */
#ifndef SONJECT_TESTS_FILE_DRAFTS_H
#define SONJECT_TESTS_FILE_DRAFTS_H

#define _GNU_SOURCE

#include <zlib.h>

#include "base/byte_order.h"
#include "base/hdf5_values.h"
#include "claims.h"
#include "swath/decoder.h"
#include "swath/swath_file.h"
#include "temporary_folder.h"

#define ROWS         3
#define COLUMNS      4
#define SAMPLES      (ROWS * COLUMNS)
#define LARGEST_FILE 65536

/* A file in the making. */
struct draft {
    unsigned char bytes[LARGEST_FILE];
    size_t count;
};

static inline void add(struct draft *draft, const void *bytes, size_t count)
{
    assert_true(draft->count + count <= sizeof draft->bytes);
    memcpy(draft->bytes + draft->count, bytes, count);
    draft->count += count;
}

static inline void add_number(struct draft *draft, uint64_t number, size_t size)
{
    unsigned char bytes[8];
    number_to_bytes(number, bytes, size, false);
    add(draft, bytes, size);
}

static inline void add_float(struct draft *draft, double sample)
{
    const float single = (float)sample;
    unsigned char bytes[4];
    uint32_t word;
    memcpy(&word, &single, sizeof word);
    number_to_bytes(word, bytes, 4, false);
    add(draft, bytes, 4);
}

static inline void put(struct draft *draft, size_t place, uint64_t number, size_t size)
{
    number_to_bytes(number, draft->bytes + place, size, false);
}

/* Returns a draft's sample: 0, 1, 2, 3, 10, 11... if whole, else 0.1, 0.2, 0.3, 0.4, 1.1, 1.2... */
static inline double sample_at(bool is_whole, size_t row, size_t column)
{
    return is_whole ? 10.0 * (double)row + (double)column
                    : (double)row + 0.1 * (double)(column + 1);
}

static inline void make_npy(struct draft *draft, int how)
{
    static const char head[] = "\x93NUMPY\1\0\x46\0"
                               "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 4), }";
    (void)how;
    memset(draft->bytes, ' ', 80);
    memcpy(draft->bytes, head, sizeof head - 1);
    draft->count = 80;
    for (size_t i = 0; i < SAMPLES; i++)
        add_float(draft, sample_at(false, i / COLUMNS, i % COLUMNS));
}

/* Makes XTF: port, whose samples run from far to near, and starboard, of 16 bits. */
static inline void make_xtf(struct draft *draft, int how)
{
    const size_t ping_bytes = 256 + 2 * (64 + 2 * COLUMNS);
    (void)how;
    memset(draft, 0, sizeof *draft);
    draft->count = 1024 + ROWS * ping_bytes;
    put(draft, 0, 0x17B, 2);
    put(draft, 166, 2, 2);
    for (size_t i = 0; i < 2; i++) {
        put(draft, 256 + 128 * i, 1 + i, 1);
        put(draft, 256 + 128 * i + 4, 1, 2);
        put(draft, 256 + 128 * i + 6, 2, 2);
    }
    for (size_t ping = 0; ping < ROWS; ping++) {
        const size_t packet = 1024 + ping * ping_bytes;
        put(draft, packet, 0xFACE, 2);
        put(draft, packet + 4, 2, 2);
        put(draft, packet + 10, ping_bytes, 4);
        for (size_t i = 0; i < 2; i++) {
            const size_t channel = packet + 256 + i * (64 + 2 * COLUMNS);
            put(draft, channel, i, 2);
            put(draft, channel + 4, 0x41F00000, 4); /* 30 m */
            put(draft, channel + 42, COLUMNS, 4);
            for (size_t k = 0; k < COLUMNS; k++)
                put(draft, channel + 64 + 2 * k,
                    1000 * i + (size_t)sample_at(true, ping, COLUMNS - 1 - k), 2);
        }
    }
}

/* Makes JSF: port and starboard of 16 bits, or pairs of them (how: PAIRS). A ping is a message. */
static inline void make_jsf(struct draft *draft, int how)
{
    const size_t pair = how ? 2 : 1;
    const size_t bytes = 240 + 2 * pair * COLUMNS;
    memset(draft, 0, sizeof *draft);
    draft->count = 2 * ROWS * (16 + bytes);
    for (size_t i = 0; i < 2 * (size_t)ROWS; i++) {
        const size_t message = i * (16 + bytes);
        const size_t ping = message + 16;
        put(draft, message, 0x1601, 2);
        put(draft, message + 4, 80, 2);
        put(draft, message + 7, 20, 1);
        put(draft, message + 8, i % 2, 1);
        put(draft, message + 12, bytes, 4);
        put(draft, ping + 34, pair - 1, 2);
        put(draft, ping + 114, COLUMNS, 2);
        put(draft, ping + 116, 20000, 4); /* ns */
        for (size_t k = 0; k < COLUMNS; k++) {
            const size_t sample = 1000 * (i % 2) + (size_t)sample_at(true, i / 2, k);
            put(draft, ping + 240 + 2 * pair * k, sample, 2);
            if (how)
                put(draft, ping + 242 + 4 * k, 0x10000 - sample, 2);
        }
    }
}

/* MATLAB's numbers of the types of elements. */
enum {
    MAT_INT8 = 1,
    MAT_UINT8 = 2,
    MAT_UINT16 = 4,
    MAT_INT32 = 5,
    MAT_UINT32 = 6,
    MAT_DOUBLE = 9,
    MAT_MATRIX = 14,
    MAT_COMPRESSED = 15
};
#define MAT_HEADER_BYTES 128

static inline void begin_mat(struct draft *draft)
{
    memset(draft->bytes, ' ', 116);
    memcpy(draft->bytes, "MATLAB 5.0 MAT-file", 19);
    memset(draft->bytes + 116, 0, 8);
    memcpy(draft->bytes + 124, "\x00\x01IM", 4);
    draft->count = MAT_HEADER_BYTES;
}

static inline void add_element(struct draft *draft, uint32_t type, const void *bytes, size_t count)
{
    static const unsigned char zeros[8];
    add_number(draft, type, 4);
    add_number(draft, count, 4);
    add(draft, bytes, count);
    add(draft, zeros, (8 - count % 8) % 8);
}

/* Adds a variable. parts: one or two arrays of rows x columns numbers of the stored type. */
static inline void add_variable(struct draft *draft, const char *name, uint32_t kind, uint32_t rows,
                                uint32_t columns, uint32_t type, const void *const *parts)
{
    const size_t start = draft->count;
    const size_t size = type == MAT_DOUBLE ? 8 : type == MAT_UINT16 ? 2 : 1;
    const uint32_t flags[2] = {kind | (parts[1] ? 0x800u : 0), 0};
    const uint32_t sides[2] = {rows, columns};
    add_element(draft, MAT_MATRIX, "", 0);
    add_element(draft, MAT_UINT32, flags, sizeof flags);
    add_element(draft, MAT_INT32, sides, sizeof sides);
    add_element(draft, MAT_INT8, name, strlen(name));
    for (int i = 0; i < 2 && parts[i]; i++)
        add_element(draft, type, parts[i], rows * columns * size);
    put(draft, start + 4, draft->count - start - 8, 4);
}

/* Returns the number of bytes of the variable at a place. */
static inline size_t variable_bytes(const struct draft *draft, size_t place)
{
    return 8 + (size_t)number_from_bytes(draft->bytes + place + 4, 4, false);
}

static inline void add_compressed(struct draft *draft, const unsigned char *bytes, size_t count)
{
    unsigned char deflated[2048];
    uLongf deflated_bytes = sizeof deflated;
    assert_int_equal(compress2(deflated, &deflated_bytes, bytes, (uLong)count, 6), Z_OK);
    add_number(draft, MAT_COMPRESSED, 4);
    add_number(draft, deflated_bytes, 4);
    add(draft, deflated, deflated_bytes);
}

/* Variants of MATLAB and HDF5 files. */
enum {
    MATLAB = 1,
    CHUNKS = 2,
    PAIRS = 4,  /* complex numbers */
    LATEST = 8, /* HDF5's format with checksums */
    HDF5_KINDS = 16,
    COMPRESSED = 16
};

/* Makes MATLAB: a scalar, "img" of doubles, "packed" of doubles stored as bytes, and a text. */
static inline void make_mat(struct draft *draft, int how)
{
    static const double rate = 48000.0;
    double numbers[2][SAMPLES];
    uint8_t packed[SAMPLES];
    for (size_t i = 0; i < SAMPLES; i++) {
        numbers[0][i] = sample_at(false, i % ROWS, i / ROWS);
        numbers[1][i] = -numbers[0][i];
        packed[i] = (uint8_t)sample_at(true, i % ROWS, i / ROWS);
    }
    begin_mat(draft);
    add_variable(draft, "rate", 6, 1, 1, MAT_DOUBLE, (const void *const[]){&rate, NULL});
    add_variable(draft, "img", 6, ROWS, COLUMNS, MAT_DOUBLE,
                 (const void *const[]){numbers[0], how & PAIRS ? numbers[1] : NULL});
    add_variable(draft, "packed", 6, ROWS, COLUMNS, MAT_UINT8, (const void *const[]){packed, NULL});
    add_variable(draft, "note", 4, 1, 4, MAT_UINT16, (const void *const[]){"t\0e\0x\0t", NULL});
    if (how & COMPRESSED) {
        static struct draft plain;
        plain = *draft;
        begin_mat(draft);
        for (size_t place = MAT_HEADER_BYTES; place < plain.count;
             place += variable_bytes(&plain, place))
            add_compressed(draft, plain.bytes + place, variable_bytes(&plain, place));
    }
}

#ifdef HAS_HDF5
/* Puts a data set of 3 x 4 doubles, or pairs of them. */
static inline void put_set(hid_t parent, const char *name, int how)
{
    static const char *const names[2][2] = {{"r", "i"}, {"real", "imag"}};
    const hsize_t sides[2] = {how & MATLAB ? COLUMNS : ROWS, how & MATLAB ? ROWS : COLUMNS};
    const size_t parts = how & PAIRS ? 2 : 1;
    double numbers[2 * SAMPLES];
    for (size_t i = 0; i < SAMPLES; i++) {
        const size_t row = how & MATLAB ? i % ROWS : i / COLUMNS;
        const size_t column = how & MATLAB ? i / ROWS : i % COLUMNS;
        numbers[parts * i + parts - 1] = -sample_at(false, row, column);
        numbers[parts * i] = sample_at(false, row, column);
    }
    const hid_t space = H5Screate_simple(2, sides, NULL);
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    const hid_t type = parts == 2 ? H5Tcreate(H5T_COMPOUND, 16) : H5Tcopy(H5T_NATIVE_DOUBLE);
    for (size_t i = 0; i < 2 && parts == 2; i++)
        H5Tinsert(type, names[how & MATLAB][i], 8 * i, H5T_NATIVE_DOUBLE);
    if (how & CHUNKS) {
        H5Pset_chunk(creation, 2, (const hsize_t[]){2, 2});
        H5Pset_shuffle(creation);
        H5Pset_deflate(creation, 4);
        H5Pset_fletcher32(creation);
    }
    const hid_t set = H5Dcreate2(parent, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    assert_true(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers) >= 0);
    assert_true(hdf5_write_text(set, "sonject:range_axis", "slant"));
    assert_true(!(how & MATLAB) || hdf5_write_text(set, "MATLAB_class", "double"));
    H5Dclose(set);
    H5Tclose(type);
    H5Pclose(creation);
    H5Sclose(space);
}

/* Writes "deep/img" in a group and, where is_full, "other" and a link to another file. */
static inline void write_hdf5(const char *path, int how, bool is_full)
{
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    const hid_t creation = H5Pcreate(H5P_FILE_CREATE);
    if (how & LATEST)
        H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    if (how & MATLAB)
        H5Pset_userblock(creation, 512);
    const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, creation, access);
    const hid_t group = H5Gcreate2(file, "deep", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    put_set(group, "img", how);
    if (is_full) {
        put_set(file, "other", how);
        H5Lcreate_external("elsewhere.h5", "/img", file, "outside", H5P_DEFAULT, H5P_DEFAULT);
    }
    H5Gclose(group);
    H5Pclose(creation);
    H5Pclose(access);
    assert_true(H5Fclose(file) >= 0);
}
#endif

#endif
