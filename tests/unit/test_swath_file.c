/* Tests files that hold a swath: which sample is where, and what a copy keeps. Files that are cut
 * short, damaged or not for sonject must all get an answer. SONJECT_MUTATIONS: the number of
 * damaged HDF5 files to try. */
#include "file_drafts.h"

#include "clean_folder.h"

#include <errno.h>
#ifdef HAS_POSIX
#include <sys/wait.h>
#endif

#ifndef MUTATIONS
#define MUTATIONS 300
#endif

static void write_draft(const char *path, const struct draft *draft, size_t count)
{
    write_bytes(path, draft->bytes, count);
}

static void read_draft(const char *path, struct draft *draft)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    draft->count = fread(draft->bytes, 1, sizeof draft->bytes, file);
    fclose(file);
}

#ifdef HAS_HDF5
static void make_hdf5(struct draft *draft, int how)
{
    const char *path = file_in("scratch.h5");
    write_hdf5(path, how, false);
    read_draft(path, draft);
    (void)unlink(path);
}
#endif

/* A kind of file, of 3 x 4 samples. */
struct kind {
    const char *name;
    void (*make)(struct draft *draft, int how);
    int how;
    const char *array, *other; /* NULL: the file has no names, or no other one */
    enum pixel_type type;
    bool is_whole;  /* samples are whole numbers; else with fractions */
    size_t at_most; /* bytes that one new sample changes; 0: the copy is a new file */
};

static const struct kind kinds[] = {
    {"a.npy", make_npy, 0, NULL, NULL, PIXEL_FLOAT32, false, 4},
    {"a.xtf", make_xtf, 0, NULL, NULL, PIXEL_UINT16, true, 2},
    {"a.jsf", make_jsf, 0, NULL, NULL, PIXEL_UINT16, true, 2},
    {"b.jsf", make_jsf, PAIRS, NULL, NULL, PIXEL_FLOAT32, true, 4},
    {"a.mat", make_mat, 0, "img", "packed", PIXEL_FLOAT32, false, 8},
    {"b.mat", make_mat, 0, "packed", "img", PIXEL_FLOAT32, true, 0},
    {"c.mat", make_mat, PAIRS, "img", "packed", PIXEL_FLOAT32, false, 16},
    {"d.mat", make_mat, COMPRESSED, "img", "packed", PIXEL_FLOAT32, false, 0},
    {"e.mat", make_mat, COMPRESSED | PAIRS, "img", "packed", PIXEL_FLOAT32, false, 0},
};

/* Gives the kinds of the table, then those of HDF5. Returns false behind the last. */
static bool next_kind(size_t i, struct kind *kind)
{
    if (i < COUNT(kinds)) {
        *kind = kinds[i];
        return true;
    }
#ifdef HAS_HDF5
    const int how = (int)(i - COUNT(kinds));
    *kind = (struct kind){"a.h5", make_hdf5, how, NULL, NULL, PIXEL_FLOAT32, false, 0};
    kind->at_most = how & CHUNKS ? 0 : how & PAIRS ? 16 : 8;
    return how < HDF5_KINDS;
#else
    return false;
#endif
}

static uint32_t channels_of(const struct kind *kind)
{
    return kind->how & PAIRS ? 2 : 1;
}

static bool is_recording(const struct kind *kind)
{
    return kind->make == make_xtf || kind->make == make_jsf;
}

static sonject_status open_kind(struct report *by, const char *path, const struct kind *kind,
                                struct swath_file **file)
{
    return swath_file_open_array(by, path,
                                 is_recording(kind) ? SONJECT_CHANNEL_PORT : SONJECT_CHANNEL_ONLY,
                                 kind->array, file);
}

/* Computes the samples of a region. In a patched file the image's last sample is another one. */
static void expected_samples(const struct kind *kind, const struct region *region, bool is_patched,
                             void *samples)
{
    size_t i = 0;
    for (size_t row = region->first_row; row < region->first_row + region->rows; row++)
        for (size_t column = region->first_column; column < region->first_column + region->columns;
             column++)
            for (uint32_t channel = 0; channel < channels_of(kind); channel++) {
                const bool is_new = is_patched && row == 2 && column == 3;
                const double number = is_new           ? (kind->make == make_jsf ? 99.0 : 99.25)
                                      : kind->is_whole ? sample_at(true, row, column)
                                                       : sample_at(false, row, column);
                (void)pixel_store(kind->type, samples, i++, channel ? 0.0 - number : number);
            }
}

static const struct region whole = {0, 0, ROWS, COLUMNS};
static const struct region inside = {1, 2, 2, 2};

/* OK: the file was read. is_right: every sample is as it should be. */
static sonject_status take(struct report *by, const char *path, const struct kind *kind,
                           bool is_patched, bool *is_right)
{
    float samples[2 * SAMPLES] = {0}, expected[2 * SAMPLES] = {0};
    struct swath_file *file;
    struct raster_layout layout;
    *is_right = false;
    sonject_status status = open_kind(by, path, kind, &file);
    if (status == SONJECT_OK) {
        swath_file_layout(file, &layout);
        *is_right = layout.rows == ROWS && layout.columns == COLUMNS &&
                    layout.channels == channels_of(kind) && layout.type == kind->type;
        if (*is_right)
            status = swath_file_read(by, file, &whole, samples);
        expected_samples(kind, &whole, is_patched, expected);
        *is_right = *is_right && memcmp(samples, expected, sizeof expected) == 0;
        swath_file_close(&file);
    }
    return status;
}

static void expect_taken(struct report *by, const char *path, const struct kind *kind,
                         bool is_patched)
{
    bool is_right;
    if (take(by, path, kind, is_patched, &is_right) != SONJECT_OK || !is_right)
        fail_msg("%s (%d): is wrong, or %s", kind->name, kind->how, by->message);
}

/* Reads a file, patches one sample and reads the copy. back gets the copy. */
static void read_and_patch(struct report *by, const char *path, const struct kind *kind,
                           struct draft *back)
{
    float samples[8] = {0};
    struct swath_file *file;
    const char *copy = file_in("copy");
    struct kind other = *kind;
    expect_taken(by, path, kind, false);
    EXPECT_OK(by, open_kind(by, path, kind, &file));
    assert_null(swath_file_new_extension(file));
    expected_samples(kind, &inside, true, samples);
    EXPECT_OK(by, swath_file_copy_with_patch(by, file, copy, &inside, samples, NULL, NULL));
    swath_file_close(&file);
    expect_taken(by, copy, kind, true);
    if (kind->other) {
        other.array = kind->other;
        other.is_whole = strcmp(kind->other, "packed") == 0;
        other.how = other.is_whole ? 0 : kind->how;
        expect_taken(by, copy, &other, false);
    }
    read_draft(copy, back);
}

/* Numbers such as 0.1 keep all their bits, and MATLAB's variables around them keep all bytes. */
CLEAN(a_patch_is_all_that_changes_here_and_in_a_child)
{
    static struct draft draft, backs[2];
    struct decoder own = {.is_in_process = true};
    const struct report_host alone = {.decoder = &own};
    struct report here = {.host = &alone};
    struct kind kind;
    for (size_t i = 0; next_kind(i, &kind); i++) {
        const char *path = file_in(kind.name);
        size_t different = 0;
        kind.make(&draft, kind.how);
        write_draft(path, &draft, draft.count);
        read_and_patch(&report, path, &kind, &backs[0]);
        read_and_patch(&here, path, &kind, &backs[1]);
        assert_int_equal(backs[0].count, backs[1].count);
        assert_memory_equal(backs[0].bytes, backs[1].bytes, backs[0].count);
        for (size_t k = 0; k < draft.count; k++)
            different += backs[0].bytes[k] != draft.bytes[k];
        if (kind.at_most > 0 &&
            (backs[0].count != draft.count || different < 1 || different > kind.at_most))
            fail_msg("%s (%d): %zu bytes have changed", kind.name, kind.how, different);
        if (kind.make == make_mat) {
            assert_memory_equal(backs[0].bytes, draft.bytes,
                                MAT_HEADER_BYTES + variable_bytes(&draft, MAT_HEADER_BYTES));
            assert_memory_equal(backs[0].bytes + backs[0].count - 16,
                                draft.bytes + draft.count - 16, 16);
        }
        if (kind.make == make_mat && kind.how == 0 && kind.at_most == 0) /* room for any double */
            assert_int_equal(backs[0].count, draft.count + 8 * SAMPLES - 16);
    }
    assert_true(decoder.starts <= 1 && own.starts == 0);
    decoder_stop(&own);
}

CLEAN(a_cut_file_is_never_taken)
{
    static struct draft draft;
    const struct kind *kind = &kinds[0]; /* each of this file's bytes is needed */
    const char *path = file_in(kind->name);
    bool is_right;
    kind->make(&draft, kind->how);
    for (size_t count = 0; count < draft.count; count++) {
        write_draft(path, &draft, count);
        if (take(&report, path, kind, false, &is_right) != SONJECT_ERROR_INPUT)
            fail_msg("%s: %zu bytes of %zu were taken", kind->name, count, draft.count);
    }
}

/* Opens a file, reads a corner or all, and writes a copy with these samples; copy: name or NULL. */
static sonject_status use_file(const char *path, const struct kind *kind, const char *copy)
{
    static float samples[2 * 256 * 256];
    struct swath_file *file;
    struct raster_layout layout;
    report.message[0] = '\0';
    sonject_status status = open_kind(&report, path, kind, &file);
    if (status != SONJECT_OK)
        return status;
    (void)swath_file_range_axis(file);
    swath_file_layout(file, &layout);
    const struct region corner = {0, 0, layout.rows < 256 ? layout.rows : 256,
                                  layout.columns < 256 ? layout.columns : 256};
    status = swath_file_read(&report, file, &corner, samples);
    if (status == SONJECT_OK && copy)
        status = swath_file_copy_with_patch(&report, file, copy, &corner, samples, NULL, NULL);
    swath_file_close(&file);
    return status;
}

static uint32_t draw(uint64_t *state)
{
    return (uint32_t)(next_random(state) >> 33);
}

/* Changes some bytes, most of them where structure is, or numbers of 4 or 8 bytes. Returns the
 * number of bytes to keep: now and then the end is missing. */
static size_t damage(struct draft *draft, uint64_t *state)
{
    static const uint64_t numbers[] = {0, 1, 0xFF, 0xFFFF, 0x7FFFFFFF, UINT64_MAX, INT64_MAX};
    const size_t most = draft->count - 8;
    const uint32_t changes = 1 + draw(state) % 6;
    for (uint32_t i = 0; i < changes; i++) {
        const size_t place = draw(state) % (draw(state) % 2 && most > 300 ? 300 : most);
        if (draw(state) % 4 == 0)
            memcpy(draft->bytes + place, &numbers[draw(state) % 7], draw(state) % 2 ? 8 : 4);
        else
            draft->bytes[place] = (unsigned char)draw(state);
    }
    return draw(state) % 16 == 0 ? 1 + draw(state) % draft->count : draft->count;
}

/* The host goes on, and neither a process nor a file is left. In some kinds of files a changed byte
 * is harmless, or changes a sample. */
CLEAN(damaged_files_end_no_host)
{
    static struct draft draft, damaged;
    struct kind kind;
    uint64_t seed = 1;
    const char *wanted = getenv("SONJECT_MUTATIONS");
    const long most = wanted ? strtol(wanted, NULL, 10) : MUTATIONS;
    long taken = 0;
    long tried = 0;
    for (size_t i = 0; next_kind(i, &kind); i++) {
        const bool is_decoded =
            kind.make != make_npy && !is_recording(&kind) && kind.make != make_mat;
        const long mutations = is_decoded ? most / HDF5_KINDS + 1 : 10 * most;
        const char *path = file_in(kind.name);
        const char *copy = file_in("copy");
        kind.make(&draft, kind.how);
        for (long k = 0; k < mutations; k++, tried++) {
            damaged = draft;
            write_draft(path, &damaged, damage(&damaged, &seed));
            const sonject_status status = use_file(path, &kind, k % 3 ? NULL : copy);
            if (status != SONJECT_OK && status != SONJECT_ERROR_INPUT &&
                status != SONJECT_ERROR_UNSUPPORTED)
                fail_msg("%s, file %ld: status %d: %s", kind.name, k, (int)status, report.message);
            if (status != SONJECT_OK && !strstr(report.message, kind.name))
                fail_msg("'%s' does not name %s", report.message, kind.name);
            taken += status == SONJECT_OK;
        }
        (void)unlink(path);
        (void)unlink(copy);
        assert_int_equal(count_entries(folder->path), 0);
    }
    assert_true(taken > 0 && taken < tried);
    decoder_stop(&decoder);
#ifdef HAS_POSIX
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
    assert_int_equal(errno, ECHILD);
#endif
}

static void expect_refused(const char *name, const char *array, const void *bytes, size_t count,
                           const char *words)
{
    struct swath_file *file;
    const char *path = file_in(name);
    if (bytes)
        write_bytes(path, bytes, count);
    assert_int_equal(swath_file_open_array(&report, path, SONJECT_CHANNEL_ONLY, array, &file),
                     SONJECT_ERROR_INPUT);
    if (!strstr(report.message, words) || !strstr(report.message, name))
        fail_msg("'%s' is not in '%s'", words, report.message);
}

/* Arrays are found beside a damaged group, too. */
CLEAN(arrays_are_told_by_their_names)
{
    static struct draft draft;
    make_mat(&draft, 0);
    expect_refused("a.mat", NULL, draft.bytes, draft.count, "img (3 x 4), packed (3 x 4)");
    expect_refused("a.mat", "none", NULL, 0, "choose one of img (3 x 4), packed (3 x 4)");
#ifdef HAS_HDF5
    struct swath_file *file;
    const char *path = file_in("a.h5");
    write_hdf5(path, 0, true);
    expect_refused("a.h5", NULL, NULL, 0, "deep/img (3 x 4), other (3 x 4)");
    expect_refused("a.h5", "none", NULL, 0, "choose one of deep/img (3 x 4), other (3 x 4)");
    expect_refused("a.h5", "outside", NULL, 0, "holds no array 'outside'");
    EXPECT_OK(&report,
              swath_file_open_array(&report, path, SONJECT_CHANNEL_ONLY, "/deep/img", &file));
    swath_file_close(&file);
    read_draft(path, &draft);
    unsigned char *names = memmem(draft.bytes, draft.count, "HEAP", 4); /* the root's links */
    names = memmem(names + 4, draft.count - (size_t)(names + 4 - draft.bytes), "HEAP", 4);
    memset(names, 0, 4);
    write_draft(path, &draft, draft.count);
    for (int is_named = 0; is_named < 2; is_named++) {
        EXPECT_OK(&report, swath_file_open_array(&report, path, SONJECT_CHANNEL_ONLY,
                                                 is_named ? "other" : NULL, &file));
        swath_file_close(&file);
    }
    expect_refused("a.h5", "deep/img", NULL, 0, "holds no array 'deep/img'");
#endif
}

/* Headers promise a float32 array of 2^40 x 2^40 in a hundred bytes, or end within a word. Nothing
 * behind them may be looked at, which tools that watch memory see. */
CLEAN(test_headers_of_numpy_that_lie_or_end_early)
{
    static const char *const headers[] = {
        "{'descr':'<f4','fortran_order':False,'shape':(1099511627776, 1099511627776)}",
        "{'descr':'<f4','fortran_order':False,'shape':(99999999999999999999999, 4)}",
        "{'descr':'<f4','fortran_order':False,'shape':(4, -5)}",
        "{'descr':'<f4','fortran_order':False,'shape':(0, 5)}",
        "{'descr':'<f4','fortran_order':False,'shape':(4, 5, 6)}",
        "{'descr':'<f4','fortran_order':False,'shape':(4,)}",
        "{'descr':'<f4','fortran_order':False,'shape':()}",
        "{'fortran_order': False, 'shape': (4, 5), 'descr': '",
        "{'fortran_order': False, 'shape': (4, 5), 'descr': '<",
        "{'fortran_order': False, 'shape': (4, 5), 'descr': '<f4",
        "{'descr': '<f4', 'shape': (4, 5), 'fortran_order': F",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (4, 5",
        "{'descr': '<f4', 'fortran_order': False, 'shape'"};
    for (size_t i = 0; i < COUNT(headers); i++) {
        unsigned char bytes[10 + 80 + 80] = {0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0};
        bytes[8] = (unsigned char)strlen(headers[i]);
        memcpy(bytes + 10, headers[i], bytes[8]);
        expect_refused("a.npy", NULL, bytes, sizeof bytes, "");
    }
}

/* Headers promise 2^31 x 2^31 doubles, and 4 GB, in a few hundred bytes. */
CLEAN(test_sizes_of_matlab_that_lie)
{
    static struct draft draft, compressed;
    make_mat(&draft, 0);
    const size_t image = MAT_HEADER_BYTES + variable_bytes(&draft, MAT_HEADER_BYTES);
    const size_t count = variable_bytes(&draft, image);
    memset(draft.bytes + image + 8 + 16 + 8, 0x7F, 8);
    expect_refused("a.mat", "img", draft.bytes, draft.count, "damaged");
    make_mat(&draft, 0);
    memset(draft.bytes + image + 4, 0xFF, 4);
    begin_mat(&compressed);
    add_compressed(&compressed, draft.bytes + image, count);
    expect_refused("a.mat", NULL, compressed.bytes, compressed.count, "damaged");
}

/* Formats that sonject does not read are named beside those that it reads. */
CLEAN(test_files_that_are_not_for_sonject)
{
    static const struct {
        const char *bytes;
        size_t count;
        const char *words;
    } cases[] = {{"Pf 4 3 2.0\n", 11, "is a PFM file"},
                 {"P5 1 2 255\nab", 13, "is a PGM file"},
                 {"BM and more of it all", 19, "is a BMP file"},
                 {"", 0, "is empty; sonject reads XTF"},
                 {"GIF89a", 6, "is a GIF file"},
                 {"SDPX and more of it", 19, "is a DPX file"},
                 {"P6 and more of it all", 19, "is a PPM file"},
                 {"\0\0\0\x0CjP  \r\n\x87\n and more", 19, "is a JPEG 2000 file"},
                 {"\xFF\x4F\xFF\x51 and more of it", 19, "is a JPEG 2000 file"},
                 {"SIMPLE  =          T", 19, "is a FITS file"},
                 {"\0\0\3\0\0\0\0\0\0\0\0\0\4\0\3\0\x08 it", 19, "is a Targa file"},
                 {"nothing that is known", 19, "of no format that sonject knows"}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        expect_refused("a.bin", NULL, cases[i].bytes, cases[i].count, cases[i].words);
        expect_refused("a.bin", NULL, NULL, 0,
                       "reads XTF, JSF, NumPy (.npy), MATLAB (.mat), TIFF, PNG, JPEG, HDF5: "
                       "convert it to one of these, such as TIFF or PNG");
    }
    expect_refused("missing.tif", NULL, NULL, 0, "No such file");
    expect_refused(".", NULL, NULL, 0, "directory");
}

TEST_PROGRAM(NULL, NULL)
