/* Tests that an unreadable disk is not taken for a damaged file. Whichever of a reader's calls
 * fails, the status is STORAGE. The message names the file (or the copy) and has the system's
 * words. */
#include "claims.h"

#include <errno.h>
#include <sys/stat.h>

#include "fault/faults.h"
#include "swath/raster_file.h"
#include "swath/swath_file.h"
#include "unit/temporary_folder.h"

#define SIDE       16
#define MARK_ERROR 0x20 /* glibc's _IO_ERR_SEEN, since the wrapped call is glibc's */

WRAPPED(size_t, fread, void *bytes, size_t size, size_t count, FILE *file);
WRAPPED(ssize_t, read, int descriptor, void *bytes, size_t count);

static long calls, due; /* number of calls, and of the one that fails; 0: none fails */

/* Returns whether a call fails. Only regular files count, not the source of random file names. */
static bool is_due(int descriptor)
{
    struct stat facts;
    if (fstat(descriptor, &facts) != 0 || !S_ISREG(facts.st_mode) || ++calls != due)
        return false;
    errno = EIO;
    return true;
}

size_t __wrap_fread(void *bytes, size_t size, size_t count, FILE *file)
{
    if (!is_due(fileno(file)))
        return __real_fread(bytes, size, count, file);
    file->_flags |= MARK_ERROR;
    return 0;
}

ssize_t __wrap_read(int descriptor, void *bytes, size_t count)
{
    return is_due(descriptor) ? -1 : __real_read(descriptor, bytes, count);
}

static sonject_status use(struct report *report, const char *path, const char *copy)
{
    static float pixels[2 * SIDE * SIDE];
    struct swath_file *file;
    const struct region corner = {0, 0, 2, 2};
    sonject_status status = swath_file_open_array(report, path, SONJECT_CHANNEL_ONLY,
                                                  strstr(path, ".mat") ? "depths" : NULL, &file);
    if (status != SONJECT_OK)
        return status;
    status = swath_file_read(report, file, &corner, pixels);
    THEN(status, swath_file_copy_with_patch(report, file, copy, &corner, pixels, NULL, NULL));
    swath_file_close(&file);
    return status;
}

static void expect_told(const char *path, const char *copy)
{
    struct report report = {.host = NULL};
    long count = 0;
    due = 0;
    calls = 0;
    EXPECT_OK(&report, use(&report, path, copy));
    count = calls;
    assert_true(count > 0);
    for (long n = 1; n <= count; n++) {
        due = n;
        calls = 0;
        (void)remove(copy);
        report.message[0] = '\0';
        const sonject_status status = use(&report, path, copy);
        due = 0;
        if (status != SONJECT_ERROR_STORAGE || !strstr(report.message, strerror(EIO)) ||
            (!strstr(report.message, path) && !strstr(report.message, copy)))
            fail_msg("%s: call %ld of %ld: status %d, %s", path, n, count, (int)status,
                     report.message);
    }
    print_message("%s: %ld calls\n", path, count);
}

IN_FOLDER(test_written_formats)
{
    static const struct {
        const char *name;
        enum pixel_type type;
    } formats[] = {{"a.npy", PIXEL_FLOAT32},
                   {"a.tif", PIXEL_FLOAT32},
                   {"a.png", PIXEL_UINT16},
                   {"a.jpg", PIXEL_UINT8},
                   {"a.h5", PIXEL_FLOAT32}};
    static float pixels[SIDE * SIDE];
    expect_told(SOURCE_ROOT "/tests/unit/heights.mat", temporary_file(*state, "copy.mat"));
    for (size_t i = 0; i < COUNT(formats); i++) {
        struct report report = {.host = NULL};
        char path[TEMPORARY_CAPACITY + 300], copy[TEMPORARY_CAPACITY + 300];
        const struct raster_layout layout = {SIDE, SIDE, 1, formats[i].type};
        snprintf(path, sizeof path, "%s", temporary_file(*state, formats[i].name));
        snprintf(copy, sizeof copy, "%s", temporary_file(*state, "copy"));
        (void)strcat(copy, formats[i].name + 1);
        const bool is_lossy = strstr(path, ".jpg");
        EXPECT_OK(&report,
                  (is_lossy ? raster_file_write(&report, path, &layout, NULL, NULL, 0, pixels)
                            : raster_format_write(&report, path, &layout, NULL, 0, pixels)));
        expect_told(path, copy);
    }
}

#ifdef FAILING_PREAD
IN_FOLDER(test_a_disk_under_the_decoder)
{
    static float pixels[SIDE * SIDE];
    static const struct raster_layout layout = {SIDE, SIDE, 1, PIXEL_FLOAT32};
    struct report report = {.host = NULL};
    char path[TEMPORARY_CAPACITY + 300], number[24];
    snprintf(path, sizeof path, "%s", temporary_file(*state, "a.h5"));
    const char *copy = temporary_file(*state, "copy.h5");
    assert_int_equal(raster_format_write(&report, path, &layout, NULL, 0, pixels), SONJECT_OK);
    assert_int_equal(setenv("LD_PRELOAD", FAILING_PREAD, 1), 0);
    long n = 0;
    sonject_status status = SONJECT_ERROR_STORAGE;
    while (status != SONJECT_OK) {
        snprintf(number, sizeof number, "%ld", ++n);
        assert_int_equal(setenv("FAULT_PREAD", number, 1), 0);
        status = use(&report, path, copy);
        if (status != SONJECT_OK &&
            (status != SONJECT_ERROR_STORAGE || !strstr(report.message, strerror(EIO))))
            fail_msg("call %ld: status %d, %s", n, (int)status, report.message);
    }
    assert_true(n > 8);
    unsetenv("LD_PRELOAD");
}
#endif

TEST_PROGRAM(NULL, NULL)
