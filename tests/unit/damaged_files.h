/* Files that are damaged on purpose, and what reading them must come to. */
#ifndef SONJECT_TESTS_DAMAGED_FILES_H
#define SONJECT_TESTS_DAMAGED_FILES_H

#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64

#include "base/byte_order.h"
#include "claims.h"
#include "swath/decoder.h"
#include "swath/swath_file.h"
#include "temporary_folder.h"

#define LARGEST_FILE 65536

/* One for all, as a context has it. */
static struct decoder decoder;
static const struct report_host host = {.decoder = &decoder};

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
    struct report report = {{0}, NULL, &host};
    struct swath_file *file;
    struct raster_layout layout;
    size_t bytes = 0;
    sonject_status status = swath_file_open_array(&report, path, channel, NULL, &file);
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

/* A copy with the image's own samples is the same file. */
static void expect_whole(const char *path, const char *copy, const unsigned char *bytes,
                         size_t count, int32_t channel)
{
    static unsigned char back[LARGEST_FILE];
    write_file(path, bytes, count);
    assert_int_equal(use_file(path, copy, channel), SONJECT_OK);
    FILE *file = fopen(copy, "rb");
    assert_non_null(file);
    assert_int_equal(fread(back, 1, sizeof back, file), count);
    fclose(file);
    assert_memory_equal(back, bytes, count);
}

/* Reads the file with changed bytes and cut short, `mutations` times: none but the statuses that
 * bad files give. Most places are where structure is, in the first 300 bytes. */
static inline void mutate(const char *folder, const char *name, int32_t channel,
                          const unsigned char *bytes, size_t count, int mutations)
{
    char path[512], copy[512];
    static unsigned char changed[LARGEST_FILE];
    uint32_t seed = 11;
    int taken = 0;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    snprintf(copy, sizeof copy, "%s/copy-of-%s", folder, name);
    expect_whole(path, copy, bytes, count, channel);
    for (int i = 0; i < mutations; i++) {
        memcpy(changed, bytes, count);
        seed = seed * 1664525u + 1013904223u;
        const size_t place = (seed >> 8) % (i % 2 ? count : (count < 300 ? count : 300));
        seed = seed * 1664525u + 1013904223u;
        changed[place] = i % 3 ? (unsigned char)(seed >> 24) : 0xFF;
        write_file(path, changed, i % 5 ? count : place);
        const sonject_status status = use_file(path, i % 40 ? NULL : copy, channel);
        if (status != SONJECT_OK && status != SONJECT_ERROR_INPUT &&
            status != SONJECT_ERROR_UNSUPPORTED)
            fail_msg("byte %zu: status %d", place, (int)status);
        taken += status == SONJECT_OK;
    }
    assert_true(taken > 0 && taken < mutations);
}

#endif
