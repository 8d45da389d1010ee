/* Tests the child process that reads files for a host: what its end affects, what it has of the
 * host, and what ends it. test_swath_file.c tests that it reads what the host itself would. */
#include "file_drafts.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <sonject/run.h>

#include "api/handles.h"

/* The members of a context that serve the child process. */
static struct decoder decoder;
static struct report_host host;
static struct report report;

/* Makes a host and a good HDF5 file. Returns the file's path. */
static const char *begin(struct temporary_folder *folder)
{
    const char *path = temporary_file(folder, "a.h5");
    memset(&decoder, 0, sizeof decoder);
    host = (struct report_host){.decoder = &decoder};
    report.host = &host;
    write_hdf5(path, CHUNKS, false);
    return path;
}

static void expect_no_child(void)
{
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
    assert_int_equal(errno, ECHILD);
}

static void end(void)
{
    decoder_stop(&decoder);
    expect_no_child();
}

static void expect_says(const char *words)
{
    if (!strstr(report.message, words))
        fail_msg("'%s' is not in '%s'", words, report.message);
}

static sonject_status open_image(const char *path, struct swath_file **file)
{
    return swath_file_open_array(&report, path, SONJECT_CHANNEL_ONLY, NULL, file);
}

static sonject_status read_image(struct swath_file *file)
{
    static double samples[256 * 256];
    struct raster_layout layout;
    swath_file_layout(file, &layout);
    const struct region corner = {0, 0, layout.rows < 256 ? layout.rows : 256,
                                  layout.columns < 256 ? layout.columns : 256};
    return swath_file_read(&report, file, &corner, samples);
}

static sonject_status use_file(const char *path)
{
    struct swath_file *file;
    sonject_status status = open_image(path, &file);
    THEN(status, read_image(file));
    swath_file_close(&file);
    return status;
}

/* Writes an array of one chunk, or of many, of which only the first is stored, in `bytes` bytes. */
static void write_chunk(const char *path, hid_t type, const hsize_t sides[2],
                        const hsize_t chunk[2], size_t bytes)
{
    static const char few[100];
    const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t space = H5Screate_simple(2, sides, NULL);
    const hid_t storage = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(storage, 2, chunk);
    H5Pset_deflate(storage, 1);
    const hid_t set = H5Dcreate2(file, "img", type, space, H5P_DEFAULT, storage, H5P_DEFAULT);
    if (bytes > 0)
        assert_true(H5Dwrite_chunk(set, H5P_DEFAULT, 1, (const hsize_t[]){0, 0}, bytes, few) >= 0);
    H5Dclose(set);
    H5Pclose(storage);
    H5Sclose(space);
    assert_true(H5Fclose(file) >= 0);
}

/* HDF5 1.10 reads beyond a chunk of 64 MB that is stored unpacked in 100 bytes. */
TEST(a_file_that_ends_the_decoder_ends_one_call)
{
    static const hsize_t sides[2] = {4096, 2048};
    const char *path = begin(*state);
    char overread[TEMPORARY_CAPACITY + 300];
    snprintf(overread, sizeof overread, "%s.overread", path);
    write_chunk(overread, H5T_NATIVE_DOUBLE, sides, sides, 100);
    assert_int_equal(use_file(overread), SONJECT_ERROR_INPUT);
    expect_says(".overread: is damaged: the program that reads it ended");
    assert_int_equal(use_file(path), SONJECT_OK);
    assert_int_equal(decoder.starts, 2);
    end();
}

TEST(what_was_open_in_a_dead_decoder_is_refused)
{
    struct swath_file *files[2];
    const char *path = begin(*state);
    for (int i = 0; i < 2; i++)
        EXPECT_OK(&report, open_image(path, &files[i]));
    assert_int_equal(kill((pid_t)decoder.child.number, SIGKILL), 0);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(read_image(files[i]), SONJECT_ERROR_INPUT);
        expect_says("a.h5");
        assert_int_equal(use_file(path), SONJECT_OK); /* a new child reads */
    }
    for (int i = 0; i < 2; i++)
        swath_file_close(&files[i]);
    end();
}

TEST(more_samples_than_a_file_can_hold_are_refused)
{
    const char *path = begin(*state);
    write_chunk(path, H5T_NATIVE_FLOAT, (const hsize_t[]){40000, 40000},
                (const hsize_t[]){100, 100}, 0);
    assert_int_equal(use_file(path), SONJECT_ERROR_INPUT);
    expect_says("announces 40000 x 40000 samples");
    end();
}

static rlim_t limit_of(enum __rlimit_resource resource)
{
    struct rlimit limits;
    assert_int_equal(prlimit((pid_t)decoder.child.number, resource, NULL, &limits), 0);
    return limits.rlim_cur;
}

TEST(the_child_has_limits_and_nothing_of_the_host)
{
    char list[64];
    const char *path = begin(*state);
    const int kept = open("/dev/null", O_RDONLY); /* inherited by programs that are started */
    assert_true(kept >= 0);
    assert_int_equal(use_file(path), SONJECT_OK);
    assert_int_equal(limit_of(RLIMIT_CORE), 0);
    assert_in_range(limit_of(RLIMIT_CPU), DECODER_CPU_S, DECODER_CPU_S + 10);
#ifndef IS_SANITIZED
    assert_int_equal(limit_of(RLIMIT_AS), DECODER_MEMORY_BYTES);
#endif
    snprintf(list, sizeof list, "/proc/%ld/fd", decoder.child.number);
    assert_int_equal(count_entries(list), 3);
    close(kept);
    end();
}

TEST(the_child_ends_with_its_host)
{
    int ends[2];
    long process = 0;
    const char *path = begin(*state);
    /* a process that loses its parent becomes this process's child */
    assert_int_equal(prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
    assert_int_equal(pipe(ends), 0);
    fflush(NULL);
    const pid_t between = fork();
    if (between == 0) {
        const bool is_read = use_file(path) == SONJECT_OK;
        const ssize_t told = write(ends[1], &decoder.child.number, sizeof process);
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

/* A stopped child never answers. The host asks its caller meanwhile, and ends the child. */
TEST(a_caller_may_end_the_wait_for_the_child)
{
    struct swath_file *file;
    int asked = 0;
    const char *path = begin(*state);
    EXPECT_OK(&report, open_image(path, &file));
    host.progress = stop_now;
    host.progress_user = &asked;
    strcpy(host.stage, "reading");
    assert_int_equal(kill((pid_t)decoder.child.number, SIGSTOP), 0);
    assert_int_equal(read_image(file), SONJECT_CANCELLED);
    assert_int_equal(asked, 1);
    expect_no_child();
    swath_file_close(&file);
    end();
}

/* A call lends its progress function to code that waits for the child. */
TEST(a_run_may_be_ended_while_its_image_is_read)
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
    (void)begin(*state);
    const char *path = temporary_file(*state, "scene.yaml");
    write_bytes(path, text, sizeof text - 1);
    assert_int_equal(sonject_context_create(NULL, &context), SONJECT_OK);
    EXPECT_OK(&context->report, sonject_scene_read(context, path, NULL, &scene));
    EXPECT_OK(&context->report, sonject_check(context, scene, &told));
    sonject_text_release(&told);
    assert_int_equal(kill((pid_t)context->decoder.child.number, SIGSTOP), 0);
    params.folder = temporary_file(*state, "result");
    assert_int_equal(sonject_run(context, scene, &params, stop_now, &asked, NULL),
                     SONJECT_CANCELLED);
    assert_int_equal(asked, 1);
    sonject_scene_release(&scene);
    sonject_context_release(&context);
    expect_no_child();
}

TEST_PROGRAM(make_temporary_folder, remove_temporary_folder)
