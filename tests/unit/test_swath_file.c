/* XTF files and NumPy arrays that are damaged: whatever a byte says, the answer is a status. */
#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "io/byte_order.h"
#include "io/swath_file.h"
#include "temporary_folder.h"

#define PINGS        6
#define SAMPLES      20
#define PING_BYTES   (256 + 2 * (64 + 2 * SAMPLES))
#define XTF_BYTES    (1024 + PINGS * PING_BYTES)
#define NPY_HEADER   "{'descr': '<f4', 'fortran_order': False, 'shape': (4, 5), }"
#define NPY_BYTES    (10 + 70 + 4 * 5 * 4)
#define LARGEST_FILE (XTF_BYTES > NPY_BYTES ? XTF_BYTES : NPY_BYTES)

#ifndef MUTATIONS
#define MUTATIONS 4000
#endif

static void put(unsigned char *bytes, size_t place, uint64_t number, size_t size)
{
    number_to_bytes(number, bytes + place, size, false);
}

static void put_float(unsigned char *bytes, size_t place, float value)
{
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    put(bytes, place, word, 4);
}

/* Port and starboard of 16 bits. */
static void make_xtf(unsigned char *bytes)
{
    memset(bytes, 0, XTF_BYTES);
    put(bytes, 0, 0x7B, 1);
    put(bytes, 1, 1, 1);
    put(bytes, 166, 2, 2);
    for (size_t i = 0; i < 2; i++) {
        put(bytes, 256 + 128 * i, 1 + i, 1);
        put(bytes, 256 + 128 * i + 4, 1, 2);
        put(bytes, 256 + 128 * i + 6, 2, 2);
    }
    for (size_t ping = 0; ping < PINGS; ping++) {
        unsigned char *packet = bytes + 1024 + ping * PING_BYTES;
        put(packet, 0, 0xFACE, 2);
        put(packet, 4, 2, 2);
        put(packet, 10, PING_BYTES, 4);
        for (size_t i = 0; i < 2; i++) {
            unsigned char *channel = packet + 256 + i * (64 + 2 * SAMPLES);
            put(channel, 0, i, 2);
            put_float(channel, 4, 30.0f);
            put(channel, 42, SAMPLES, 4);
            for (size_t k = 0; k < SAMPLES; k++)
                put(channel, 64 + 2 * k, 1000 * i + 100 * ping + k, 2);
        }
    }
}

static void make_npy(unsigned char *bytes)
{
    static const unsigned char mark[] = {0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0, 70, 0};
    memset(bytes, ' ', NPY_BYTES);
    memcpy(bytes, mark, sizeof mark);
    memcpy(bytes + 10, NPY_HEADER, sizeof NPY_HEADER - 1);
    for (size_t i = 0; i < 20; i++)
        put_float(bytes, 80 + 4 * i, (float)i);
}

static void write_file(const char *path, const unsigned char *bytes, size_t count)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, count, file), count);
    assert_int_equal(fclose(file), 0);
}

/* Opens, reads all of it, and writes a copy with a patch (NULL: none). */
static sonject_status use_file(const char *path, const char *copy, int32_t channel)
{
    struct report report = {{0}, NULL, NULL};
    struct swath_file *file;
    struct raster_layout layout;
    size_t bytes = 0;
    sonject_status status = swath_file_open(&report, path, channel, &file);
    if (status == SONJECT_OK) {
        swath_file_layout(file, &layout);
        const struct region whole = {0, 0, layout.rows, layout.columns};
        assert_true(region_bytes(&layout, &whole, &bytes));
        assert_true(bytes <= 1000000);
        unsigned char *pixels = calloc(bytes, 1);
        assert_non_null(pixels);
        status = swath_file_read(&report, file, &whole, pixels);
        if (status == SONJECT_OK && copy)
            status = swath_file_copy_with_patch(&report, file, copy, &whole, pixels, NULL, NULL);
        free(pixels);
    }
    swath_file_close(&file);
    if (status != SONJECT_OK && !report.message[0])
        fail_msg("status %d without a message", (int)status);
    return status;
}

static void expect_whole(const char *path, const char *copy, const unsigned char *bytes,
                         size_t count)
{
    unsigned char back[LARGEST_FILE];
    write_file(path, bytes, count);
    assert_int_equal(
        use_file(path, copy, bytes[0] == 0x7B ? SONJECT_CHANNEL_PORT : SONJECT_CHANNEL_ONLY),
        SONJECT_OK);
    FILE *file = fopen(copy, "rb");
    assert_non_null(file);
    assert_int_equal(fread(back, 1, sizeof back, file), count);
    fclose(file);
    assert_memory_equal(back, bytes, count);
}

static void mutate(const char *folder, const char *name, const unsigned char *bytes, size_t count)
{
    char path[512], copy[512];
    unsigned char changed[LARGEST_FILE];
    uint32_t seed = 11;
    int taken = 0;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    snprintf(copy, sizeof copy, "%s/copy-of-%s", folder, name);
    expect_whole(path, copy, bytes, count);
    for (int i = 0; i < MUTATIONS; i++) {
        memcpy(changed, bytes, count);
        seed = seed * 1664525u + 1013904223u;
        const size_t place = (seed >> 8) % (i % 2 ? count : (count < 300 ? count : 300));
        seed = seed * 1664525u + 1013904223u;
        changed[place] = i % 3 ? (unsigned char)(seed >> 24) : 0xFF;
        write_file(path, changed, i % 5 ? count : place);
        const sonject_status status =
            use_file(path, i % 40 ? NULL : copy,
                     bytes[0] == 0x7B ? SONJECT_CHANNEL_PORT : SONJECT_CHANNEL_ONLY);
        if (status != SONJECT_OK && status != SONJECT_ERROR_INPUT &&
            status != SONJECT_ERROR_UNSUPPORTED)
            fail_msg("byte %zu: status %d", place, (int)status);
        taken += status == SONJECT_OK;
    }
    assert_true(taken > 0 && taken < MUTATIONS);
}

static void test_damaged_recordings(void **state)
{
    unsigned char bytes[XTF_BYTES];
    make_xtf(bytes);
    mutate(*state, "line.xtf", bytes, sizeof bytes);
}

static void test_damaged_arrays(void **state)
{
    unsigned char bytes[NPY_BYTES];
    make_npy(bytes);
    mutate(*state, "line.npy", bytes, sizeof bytes);
}

/* A float32 array of 2^40 x 2^40 in a hundred bytes. */
static void test_sizes_that_overflow(void **state)
{
    static const char *const shapes[] = {"(1099511627776, 1099511627776)",
                                         "(99999999999999999999999, 4)",
                                         "(4, -5)",
                                         "(0, 5)",
                                         "(4, 5, 6)",
                                         "(4,)",
                                         "(4, 5",
                                         "()"};
    unsigned char bytes[NPY_BYTES];
    char path[512];
    snprintf(path, sizeof path, "%s/line.npy", (const char *)*state);
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        char header[128];
        make_npy(bytes);
        memset(bytes + 10, ' ', 70);
        snprintf(header, sizeof header, "{'descr':'<f4','fortran_order':False,'shape':%s}",
                 shapes[i]);
        memcpy(bytes + 10, header, strlen(header) < 70 ? strlen(header) : 70);
        write_file(path, bytes, sizeof bytes);
        assert_int_equal(use_file(path, path, SONJECT_CHANNEL_ONLY), SONJECT_ERROR_INPUT);
    }
}

/* Headers that end within a word: nothing behind them may be looked at, which tools that watch
 * memory see. */
static void test_headers_that_end_early(void **state)
{
    static const char *const headers[] = {"{'fortran_order': False, 'shape': (4, 5), 'descr': '",
                                          "{'fortran_order': False, 'shape': (4, 5), 'descr': '<",
                                          "{'fortran_order': False, 'shape': (4, 5), 'descr': '<f4",
                                          "{'descr': '<f4', 'shape': (4, 5), 'fortran_order': F",
                                          "{'descr': '<f4', 'fortran_order': False, 'shape': (",
                                          "{'descr': '<f4', 'fortran_order': False, 'shape': (4, 5",
                                          "{'descr': '<f4', 'fortran_order': False, 'shape'"};
    char path[512];
    snprintf(path, sizeof path, "%s/line.npy", (const char *)*state);
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++) {
        unsigned char bytes[NPY_BYTES] = {0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0};
        put(bytes, 8, strlen(headers[i]), 2);
        memcpy(bytes + 10, headers[i], strlen(headers[i]));
        write_file(path, bytes, sizeof bytes);
        assert_int_equal(use_file(path, path, SONJECT_CHANNEL_ONLY), SONJECT_ERROR_INPUT);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_damaged_recordings),
        cmocka_unit_test(test_damaged_arrays),
        cmocka_unit_test(test_sizes_that_overflow),
        cmocka_unit_test(test_headers_that_end_early),
    };
    return cmocka_run_group_tests(tests, make_temporary_folder, remove_temporary_folder);
}
