/* XTF files and NumPy arrays that are damaged: whatever a byte says, the answer is a status. */
#include "damaged_files.h"

#define PINGS      6
#define SAMPLES    20
#define PING_BYTES (256 + 2 * (64 + 2 * SAMPLES))
#define XTF_BYTES  (1024 + PINGS * PING_BYTES)
#define NPY_HEADER "{'descr': '<f4', 'fortran_order': False, 'shape': (4, 5), }"
#define NPY_BYTES  (10 + 70 + 4 * 5 * 4)

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

static void test_damaged_recordings(void **state)
{
    unsigned char bytes[XTF_BYTES];
    make_xtf(bytes);
    mutate(*state, "line.xtf", SONJECT_CHANNEL_PORT, bytes, sizeof bytes, MUTATIONS);
}

static void test_damaged_arrays(void **state)
{
    unsigned char bytes[NPY_BYTES];
    make_npy(bytes);
    mutate(*state, "line.npy", SONJECT_CHANNEL_ONLY, bytes, sizeof bytes, MUTATIONS);
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

TEST_PROGRAM(make_temporary_folder, remove_temporary_folder, TEST(test_damaged_recordings),
             TEST(test_damaged_arrays), TEST(test_sizes_that_overflow),
             TEST(test_headers_that_end_early))
