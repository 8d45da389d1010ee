/* Small images in the making, and what is read from them. */
#ifndef SONJECT_TESTS_FILE_DRAFTS_H
#define SONJECT_TESTS_FILE_DRAFTS_H

#include "damaged_files.h"

#define ROWS    3
#define COLUMNS 4

#ifndef MUTATIONS
#define MUTATIONS 600
#endif

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

static inline const char *file_in(const char *folder, const char *name)
{
    static char path[2][512];
    static int turn;
    turn = !turn;
    snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
    return path[turn];
}

static inline struct swath_file *open_draft(const char *folder, const char *name, const char *array,
                                            const struct draft *draft)
{
    struct report report = {{0}, NULL, &host};
    struct swath_file *file = NULL;
    const char *path = file_in(folder, name);
    if (draft)
        write_file(path, draft->bytes, draft->count);
    if (swath_file_open_array(&report, path, SONJECT_CHANNEL_ONLY, array, &file) != SONJECT_OK)
        fail_msg("%s", report.message);
    return file;
}

static inline void expect_refused(const char *folder, const char *name, const char *array,
                                  const struct draft *draft, const char *words)
{
    struct report report = {{0}, NULL, &host};
    struct swath_file *file = NULL;
    const char *path = file_in(folder, name);
    if (draft)
        write_file(path, draft->bytes, draft->count);
    assert_int_equal(swath_file_open_array(&report, path, SONJECT_CHANNEL_ONLY, array, &file),
                     SONJECT_ERROR_INPUT);
    if (!strstr(report.message, words))
        fail_msg("'%s' is not in '%s'", words, report.message);
}

static inline void expect_layout(const struct swath_file *file, uint32_t channels,
                                 enum pixel_type type)
{
    struct raster_layout layout;
    swath_file_layout(file, &layout);
    assert_int_equal(layout.rows, ROWS);
    assert_int_equal(layout.columns, COLUMNS);
    assert_int_equal(layout.channels, channels);
    assert_int_equal(layout.type, type);
}

static const struct region inside = {1, 2, 2, 2};

/* Replaces the samples inside, reads the copy as a file, and gives its bytes. */
static inline void patch(struct swath_file *file, const char *folder, const char *copy,
                         const void *samples, struct draft *back)
{
    struct report report = {{0}, NULL, &host};
    const char *path = file_in(folder, copy);
    if (swath_file_copy_with_patch(&report, file, path, &inside, samples, NULL, NULL) != SONJECT_OK)
        fail_msg("%s", report.message);
    FILE *stream = fopen(path, "rb");
    assert_non_null(stream);
    back->count = fread(back->bytes, 1, sizeof back->bytes, stream);
    fclose(stream);
}

static inline void read_all(struct swath_file *file, void *samples)
{
    struct report report = {{0}, NULL, &host};
    const struct region whole = {0, 0, ROWS, COLUMNS};
    if (swath_file_read(&report, file, &whole, samples) != SONJECT_OK)
        fail_msg("%s", report.message);
}

#endif
