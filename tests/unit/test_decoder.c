/* Files of HDF5 read and changed by a child process: whatever they are, the host goes on, and
 * neither a process nor a file is left. SONJECT_MUTATIONS: how many damaged ones are tried. */
#define _GNU_SOURCE

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "claims.h"
#include <sonject/run.h>

#include "api/handles.h"
#include "hdf5_drafts.h"
#include "swath/decoder.h"
#include "swath/swath_file.h"
#include "temporary_folder.h"

#ifndef MUTATIONS
#define MUTATIONS 300
#endif
#define SIDE         24
#define READ_AT_MOST 65536 /* samples */

/* What a context has of it. */
struct host {
    struct decoder decoder;
    struct report_host lent;
    struct report report;
};

static void host_init(struct host *host)
{
    memset(host, 0, sizeof *host);
    host->lent.decoder = &host->decoder;
    host->report.host = &host->lent;
}

static void expect_no_child(void)
{
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
    assert_int_equal(errno, ECHILD);
}

static void expect_says(const struct host *host, const char *words)
{
    if (!strstr(host->report.message, words))
        fail_msg("'%s' is not in '%s'", words, host->report.message);
}

/* Kinds of files: what MATLAB writes, chunks, complex numbers, the format with checksums. */
enum {
    MATLAB = 1,
    CHUNKS = 2,
    PAIRS = 4,
    LATEST = 8,
    KINDS = 16
};

/* A group, a text, and the array "deep/img" of SIDE x SIDE. */
static void make_file(const char *path, int kind)
{
    static const char *const pairs[2][2] = {{"r", "i"}, {"real", "imag"}};
    static double numbers[2 * SIDE * SIDE];
    const hsize_t sides[2] = {SIDE, SIDE};
    const hsize_t chunk[2] = {7, 5};
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    const hid_t creation = H5Pcreate(H5P_FILE_CREATE);
    for (size_t i = 0; i < 2 * SIDE * SIDE; i++)
        numbers[i] = (double)i;
    if (kind & LATEST)
        H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    if (kind & MATLAB)
        H5Pset_userblock(creation, 512);
    const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, creation, access);
    const hid_t group = H5Gcreate2(file, "deep", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    put_set(group, "img", sides, numbers, kind & PAIRS ? pairs[kind & MATLAB] : NULL, kind & MATLAB,
            kind & CHUNKS ? chunk : NULL, "slant");
    H5Gclose(group);
    H5Pclose(creation);
    H5Pclose(access);
    assert_true(H5Fclose(file) >= 0);
}

/* A corner of the image, or all. */
static sonject_status read_image(struct host *host, struct swath_file *file, float **samples,
                                 struct region *region)
{
    struct raster_layout layout;
    swath_file_layout(file, &layout);
    *region = (struct region){0, 0, layout.rows < 256 ? layout.rows : 256,
                              layout.columns < 256 ? layout.columns : 256};
    *samples = calloc(2 * READ_AT_MOST, sizeof **samples);
    assert_non_null(*samples);
    return swath_file_read(&host->report, file, region, *samples);
}

/* Opens, asks, reads, and writes a copy with a patch where there is a name for it. */
static sonject_status use_file(struct host *host, const char *path, const char *copy)
{
    struct swath_file *file;
    float *samples = NULL;
    struct region region;
    host->report.message[0] = '\0';
    sonject_status status =
        swath_file_open_array(&host->report, path, SONJECT_CHANNEL_ONLY, NULL, &file);
    if (status != SONJECT_OK)
        return status;
    (void)swath_file_range_axis(file);
    status = read_image(host, file, &samples, &region);
    if (status == SONJECT_OK && copy)
        status =
            swath_file_copy_with_patch(&host->report, file, copy, &region, samples, NULL, NULL);
    free(samples);
    swath_file_close(&file);
    return status;
}

static uint32_t draw(uint64_t *state)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)(*state >> 33);
}

/* Some bytes of it, or numbers of eight bytes; now and then its end is missing. */
static size_t damage(unsigned char *bytes, size_t count, uint64_t *state)
{
    static const uint64_t numbers[] = {0, 1, 0xFF, 0xFFFF, 0x7FFFFFFF, UINT64_MAX, INT64_MAX};
    const uint32_t changes = 1 + draw(state) % 6;
    for (uint32_t i = 0; i < changes; i++) {
        const size_t place = draw(state) % (count - 8);
        if (draw(state) % 4 == 0)
            memcpy(bytes + place, &numbers[draw(state) % 7], draw(state) % 2 ? 8 : 4);
        else
            bytes[place] = (unsigned char)draw(state);
    }
    return draw(state) % 16 == 0 ? 1 + draw(state) % count : count;
}

static void damaged_files_end_no_host(void **state)
{
    struct temporary_folder *folder = *state;
    struct host host;
    char path[TEMPORARY_CAPACITY + 16], copy[TEMPORARY_CAPACITY + 16];
    uint64_t seed = 1;
    const char *wanted = getenv("SONJECT_MUTATIONS");
    const long mutations = wanted ? strtol(wanted, NULL, 10) : MUTATIONS;
    long done = 0;
    snprintf(path, sizeof path, "%s/a.h5", folder->path);
    snprintf(copy, sizeof copy, "%s/b.h5", folder->path);
    host_init(&host);
    for (long i = 0; i < mutations; i++) {
        size_t count;
        make_file(path, (int)(i % KINDS));
        unsigned char *bytes = bytes_of_file(path, &count);
        assert_int_equal(i < KINDS ? use_file(&host, path, copy) : SONJECT_OK, SONJECT_OK);
        write_bytes(path, bytes, damage(bytes, count, &seed));
        free(bytes);
        const sonject_status status = use_file(&host, path, i % 3 ? NULL : copy);
        if (status != SONJECT_OK && status != SONJECT_ERROR_INPUT &&
            status != SONJECT_ERROR_UNSUPPORTED)
            fail_msg("file %ld: %s: %s", i, sonject_status_name(status), host.report.message);
        if (status != SONJECT_OK)
            expect_says(&host, "a.h5");
        done += status == SONJECT_OK;
    }
    print_message("%ld of %ld damaged files were read, %u ended the decoder\n", done, mutations,
                  host.decoder.starts - 1);
    assert_true(done > 0 && done < mutations);
    decoder_stop(&host.decoder);
    expect_no_child();
    (void)remove(path);
    (void)remove(copy);
    assert_int_equal(count_entries(folder->path), 0);
}

/* A chunk of 64 MB that is stored unpacked in 100 bytes, behind which HDF5 1.10 reads on. */
static void make_overread(const char *path)
{
    static const char few[100];
    const hsize_t sides[2] = {4096, 2048};
    const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t space = H5Screate_simple(2, sides, NULL);
    const hid_t storage = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(storage, 2, sides);
    H5Pset_deflate(storage, 1);
    const hid_t set =
        H5Dcreate2(file, "img", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, storage, H5P_DEFAULT);
    assert_true(H5Dwrite_chunk(set, H5P_DEFAULT, 1, (const hsize_t[]){0, 0}, sizeof few, few) >= 0);
    H5Dclose(set);
    H5Pclose(storage);
    H5Sclose(space);
    assert_true(H5Fclose(file) >= 0);
}

static void a_file_that_ends_the_decoder_ends_one_call(void **state)
{
    struct host host;
    host_init(&host);
    const char *path = temporary_file(*state, "overread.h5");
    make_overread(path);
    assert_int_equal(use_file(&host, path, NULL), SONJECT_ERROR_INPUT);
    expect_says(&host, "overread.h5: is damaged: the program that reads it ended");
    path = temporary_file(*state, "a.h5");
    make_file(path, 0);
    assert_int_equal(use_file(&host, path, NULL), SONJECT_OK);
    assert_int_equal(host.decoder.starts, 2);
    decoder_stop(&host.decoder);
    expect_no_child();
}

static void what_was_open_in_a_dead_decoder_is_refused(void **state)
{
    struct host host;
    struct swath_file *files[2];
    float *samples;
    struct region region;
    host_init(&host);
    const char *path = temporary_file(*state, "a.h5");
    make_file(path, CHUNKS);
    for (int i = 0; i < 2; i++)
        assert_int_equal(
            swath_file_open_array(&host.report, path, SONJECT_CHANNEL_ONLY, NULL, &files[i]),
            SONJECT_OK);
    assert_int_equal(kill((pid_t)host.decoder.process, SIGKILL), 0);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(read_image(&host, files[i], &samples, &region), SONJECT_ERROR_INPUT);
        expect_says(&host, "a.h5");
        free(samples);
        assert_int_equal(use_file(&host, path, NULL), SONJECT_OK); /* by a new one */
    }
    for (int i = 0; i < 2; i++)
        swath_file_close(&files[i]);
    decoder_stop(&host.decoder);
    expect_no_child();
}

static void more_samples_than_a_file_can_hold_are_refused(void **state)
{
    struct host host;
    host_init(&host);
    const char *path = temporary_file(*state, "large.h5");
    const hsize_t sides[2] = {40000, 40000};
    const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t space = H5Screate_simple(2, sides, NULL);
    const hid_t storage = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(storage, 2, (const hsize_t[]){100, 100});
    H5Dclose(H5Dcreate2(file, "img", H5T_NATIVE_FLOAT, space, H5P_DEFAULT, storage, H5P_DEFAULT));
    H5Pclose(storage);
    H5Sclose(space);
    assert_true(H5Fclose(file) >= 0);
    assert_int_equal(use_file(&host, path, NULL), SONJECT_ERROR_INPUT);
    expect_says(&host, "announces 40000 x 40000 samples");
    decoder_stop(&host.decoder);
}

static void both_processes_read_and_write_the_same(void **state)
{
    static const char *const copies[] = {"b.h5", "c.h5"};
    for (int kind = 0; kind < KINDS; kind++) {
        unsigned char *bytes[2];
        size_t counts[2];
        char path[sizeof((struct temporary_folder *)NULL)->file];
        snprintf(path, sizeof path, "%s", temporary_file(*state, "a.h5"));
        make_file(path, kind);
        for (int i = 0; i < 2; i++) {
            struct host host;
            host_init(&host);
            host.decoder.is_in_process = i;
            const char *copy = temporary_file(*state, copies[i]);
            if (use_file(&host, path, copy) != SONJECT_OK)
                fail_msg("kind %d: %s", kind, host.report.message);
            assert_int_equal(host.decoder.starts, !i);
            bytes[i] = bytes_of_file(copy, &counts[i]);
            decoder_stop(&host.decoder);
        }
        assert_int_equal(counts[0], counts[1]);
        assert_memory_equal(bytes[0], bytes[1], counts[0]);
        free(bytes[0]);
        free(bytes[1]);
    }
}

static rlim_t limit_of(const struct host *host, enum __rlimit_resource resource)
{
    struct rlimit limits;
    assert_int_equal(prlimit((pid_t)host->decoder.process, resource, NULL, &limits), 0);
    return limits.rlim_cur;
}

static void the_child_has_limits(void **state)
{
    struct host host;
    host_init(&host);
    const char *path = temporary_file(*state, "a.h5");
    make_file(path, 0);
    assert_int_equal(use_file(&host, path, NULL), SONJECT_OK);
    assert_int_equal(limit_of(&host, RLIMIT_CORE), 0);
    assert_in_range(limit_of(&host, RLIMIT_CPU), DECODER_CPU_S, DECODER_CPU_S + 10);
#ifndef IS_SANITIZED
    assert_int_equal(limit_of(&host, RLIMIT_AS), DECODER_MEMORY_BYTES);
#endif
    decoder_stop(&host.decoder);
}

static void the_child_has_nothing_of_the_host(void **state)
{
    struct host host;
    char list[64];
    host_init(&host);
    const char *path = temporary_file(*state, "a.h5");
    make_file(path, 0);
    const int kept = open("/dev/null", O_RDONLY); /* which programs that are started inherit */
    assert_true(kept >= 0);
    assert_int_equal(use_file(&host, path, NULL), SONJECT_OK);
    snprintf(list, sizeof list, "/proc/%ld/fd", host.decoder.process);
    assert_int_equal(count_entries(list), 3);
    close(kept);
    decoder_stop(&host.decoder);
}

static void the_child_ends_with_its_host(void **state)
{
    struct host host;
    int ends[2];
    long process = 0;
    host_init(&host);
    const char *path = temporary_file(*state, "a.h5");
    make_file(path, 0);
    /* who loses its parent becomes this process's child */
    assert_int_equal(prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
    assert_int_equal(pipe(ends), 0);
    fflush(NULL);
    const pid_t between = fork();
    if (between == 0) {
        const bool is_read = use_file(&host, path, NULL) == SONJECT_OK;
        const ssize_t told = write(ends[1], &host.decoder.process, sizeof process);
        _exit(is_read && told == sizeof process ? 0 : 1);
    }
    int status = -1;
    assert_int_equal(waitpid(between, &status, 0), between);
    assert_int_equal(status, 0);
    assert_int_equal(read(ends[0], &process, sizeof process), sizeof process);
    assert_int_equal(waitpid((pid_t)process, &status, 0), process);
    assert_int_equal(status, 0);
    expect_no_child();
    close(ends[0]);
    close(ends[1]);
}

static int stop_now(void *user, double fraction, const char *stage)
{
    assert_true(fraction == 0.0 && *stage);
    ++*(int *)user;
    return 1;
}

/* A child that is stopped answers never; the host asks its caller meanwhile, and ends it. */
static void a_caller_may_end_the_wait_for_the_child(void **state)
{
    struct host host;
    struct swath_file *file;
    struct region region;
    float *samples = NULL;
    int asked = 0;
    host_init(&host);
    const char *path = temporary_file(*state, "a.h5");
    make_file(path, 0);
    EXPECT_OK(&host.report,
              swath_file_open_array(&host.report, path, SONJECT_CHANNEL_ONLY, NULL, &file));
    host.lent.progress = stop_now;
    host.lent.progress_user = &asked;
    strcpy(host.lent.stage, "reading");
    assert_int_equal(kill((pid_t)host.decoder.process, SIGSTOP), 0);
    assert_int_equal(read_image(&host, file, &samples, &region), SONJECT_CANCELLED);
    assert_int_equal(asked, 1);
    expect_no_child();
    free(samples);
    swath_file_close(&file);
    decoder_stop(&host.decoder);
}

/* Calls with a progress function lend it to those who wait. */
static void a_run_may_be_ended_while_its_image_is_read(void **state)
{
    static const char text[] =
        "sonject: 1\n"
        "input:\n  path: a.h5\n"
        "  geometry: {row_spacing: 1 m, column_spacing: 1 m, first_slant_range: 40 m}\n"
        "sonar: {frequency: 100 kHz, bandwidth: 30 kHz, altitude: 10 m}\n";
    sonject_context *context = NULL;
    sonject_scene *scene = NULL;
    sonject_run_params params = {.struct_size = sizeof params};
    char *told = NULL;
    int asked = 0;
    make_file(temporary_file(*state, "a.h5"), 0);
    const char *path = temporary_file(*state, "scene.yaml");
    FILE *file = fopen(path, "w");
    assert_true(file && fputs(text, file) >= 0 && fclose(file) == 0);
    assert_int_equal(sonject_context_create(NULL, &context), SONJECT_OK);
    EXPECT_OK(&context->report, sonject_scene_read(context, path, NULL, &scene));
    EXPECT_OK(&context->report, sonject_check(context, scene, &told));
    sonject_text_release(&told);
    assert_int_equal(kill((pid_t)context->decoder.process, SIGSTOP), 0);
    params.folder = temporary_file(*state, "result");
    assert_int_equal(sonject_run(context, scene, &params, stop_now, &asked, NULL),
                     SONJECT_CANCELLED);
    assert_int_equal(asked, 1);
    sonject_scene_release(&scene);
    sonject_context_release(&context);
    expect_no_child();
}

TEST_PROGRAM(make_temporary_folder, remove_temporary_folder,
             TEST(a_file_that_ends_the_decoder_ends_one_call),
             TEST(what_was_open_in_a_dead_decoder_is_refused),
             TEST(more_samples_than_a_file_can_hold_are_refused),
             TEST(both_processes_read_and_write_the_same), TEST(the_child_has_limits),
             TEST(the_child_has_nothing_of_the_host), TEST(the_child_ends_with_its_host),
             TEST(a_caller_may_end_the_wait_for_the_child),
             TEST(a_run_may_be_ended_while_its_image_is_read),
             cmocka_unit_test_setup_teardown(damaged_files_end_no_host, make_temporary_folder,
                                             remove_temporary_folder))
