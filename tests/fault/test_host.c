/* Tests that the library prints nothing and changes nothing of a process that is not its own. The
 * OpenCL driver makes changes when it is first used. The host therefore uses the driver first, in a
 * context of its own, and the library then works on the same device. */
#define _GNU_SOURCE

#include "claims.h"

#include <fcntl.h>
#include <fenv.h>
#include <locale.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <sonject/sonject.h>

#include "unit/temporary_folder.h"

#define SIDE    32
#define SIGNALS 65 /* one more than the largest signal number of Linux */

extern char **environ;

/* The state of a process that the library must leave alone, with all signals' actions. */
struct process_state {
    char locale[256], folder[4096];
    size_t environment_count;
    uint64_t environment_digest;
    int rounding, traps;
    mode_t mask;
    struct sigaction actions[SIGNALS];
    sigset_t blocked;
    int descriptors;
};

static uint64_t digest_of_text(uint64_t digest, const char *text)
{
    for (; *text; text++)
        digest = (digest ^ (unsigned char)*text) * UINT64_C(0x100000001B3);
    return digest;
}

static void read_state(struct process_state *state)
{
    memset(state, 0, sizeof *state);
    snprintf(state->locale, sizeof state->locale, "%s", setlocale(LC_ALL, NULL));
    assert_non_null(getcwd(state->folder, sizeof state->folder));
    for (char **variable = environ; *variable; variable++) {
        state->environment_count++;
        state->environment_digest = digest_of_text(state->environment_digest, *variable);
    }
    state->rounding = fegetround();
#if defined(__GLIBC__)
    state->traps = fegetexcept();
#endif
    state->mask = umask(0);
    (void)umask(state->mask);
    for (int i = 1; i < SIGNALS; i++)
        (void)sigaction(i, NULL, &state->actions[i]);
    assert_int_equal(sigprocmask(SIG_SETMASK, NULL, &state->blocked), 0);
    state->descriptors = count_entries("/proc/self/fd");
}

/* Expects an earlier state in all but the number of open files. */
static void expect_like(const struct process_state *before)
{
    struct process_state now;
    read_state(&now);
    assert_string_equal(now.locale, before->locale);
    assert_string_equal(now.folder, before->folder);
    assert_int_equal(now.environment_count, before->environment_count);
    assert_true(now.environment_digest == before->environment_digest);
    assert_int_equal(now.rounding, before->rounding);
    assert_int_equal(now.traps, before->traps);
    assert_int_equal(now.mask, before->mask);
    for (int i = 1; i < SIGNALS; i++) {
        if (now.actions[i].sa_handler != before->actions[i].sa_handler ||
            now.actions[i].sa_flags != before->actions[i].sa_flags)
            fail_msg("signal %d is taken otherwise", i);
        assert_int_equal(sigismember(&now.blocked, i), sigismember(&before->blocked, i));
    }
}

static void expect_unchanged(const struct process_state *before)
{
    struct process_state now;
    read_state(&now);
    assert_int_equal(now.descriptors, before->descriptors);
    expect_like(before);
}

/* Gives the host habits of its own. */
static void live_differently(const char *folder)
{
    if (!setlocale(LC_ALL, "de_DE.UTF-8") || strcmp(localeconv()->decimal_point, ",") != 0)
        print_message("no locale with a decimal comma can be used\n");
    (void)signal(SIGPIPE, SIG_IGN);
    (void)umask(027);
    assert_int_equal(chdir(folder), 0);
    assert_int_equal(setenv("SONJECT_TEST_OF_A_HOST", "1", 1), 0);
}

struct opencl {
    cl_device_id device;
    cl_context context;
    char name[128]; /* name of the device */
};

/* Opens the first device and builds and runs a kernel on it. */
static struct opencl use_opencl(void)
{
    static const char *source = "kernel void fill(global int *a) { a[get_global_id(0)] = 1; }";
    struct opencl opencl;
    cl_platform_id platform;
    cl_int answer;
    const size_t items = 64;
    assert_int_equal(clGetPlatformIDs(1, &platform, NULL), CL_SUCCESS);
    assert_int_equal(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &opencl.device, NULL),
                     CL_SUCCESS);
    assert_int_equal(
        clGetDeviceInfo(opencl.device, CL_DEVICE_NAME, sizeof opencl.name, opencl.name, NULL),
        CL_SUCCESS);
    opencl.context = clCreateContext(NULL, 1, &opencl.device, NULL, NULL, &answer);
    assert_non_null(opencl.context);
    cl_command_queue queue = clCreateCommandQueue(opencl.context, opencl.device, 0, &answer);
    cl_program program = clCreateProgramWithSource(opencl.context, 1, &source, NULL, &answer);
    assert_int_equal(clBuildProgram(program, 1, &opencl.device, "", NULL, NULL), CL_SUCCESS);
    cl_kernel kernel = clCreateKernel(program, "fill", &answer);
    cl_mem buffer = clCreateBuffer(opencl.context, CL_MEM_READ_WRITE, 256, NULL, &answer);
    assert_int_equal(clSetKernelArg(kernel, 0, sizeof buffer, &buffer), CL_SUCCESS);
    assert_int_equal(clEnqueueNDRangeKernel(queue, kernel, 1, NULL, &items, NULL, 0, NULL, NULL),
                     CL_SUCCESS);
    assert_int_equal(clFinish(queue), CL_SUCCESS);
    clReleaseMemObject(buffer);
    clReleaseKernel(kernel);
    clReleaseProgram(program);
    clReleaseCommandQueue(queue);
    return opencl;
}

static sonject_scene *make_scene(sonject_context *context)
{
    const sonject_scene_read_params params = {
        .struct_size = sizeof params,
        .text = "sonject: 1\n"
                "input: {uniform: {rows: 32, columns: 32}, geometry: {row_spacing: 0.05,\n"
                "  column_spacing: 0.05, first_slant_range: 25}}\n"
                "sonar: {frequency: 100e3, bandwidth: 15e3, altitude: 10}\n"
                "objects: [{shape: sphere, diameter: 0.4}]\n"};
    sonject_scene *scene;
    assert_int_equal(sonject_scene_read(context, NULL, &params, &scene), SONJECT_OK);
    return scene;
}

/* Works with the library in whole runs, failures included. */
static void work(const struct opencl *opencl, const char *folder)
{
    char results[TEMPORARY_CAPACITY + 16];
    sonject_context_params params = {.struct_size = sizeof params};
    sonject_context *context;
    sonject_run_params run = {.struct_size = sizeof run};
    sonject_scene *none;
    char *text = NULL;
    params.device_name = opencl->name;
    assert_int_equal(sonject_context_create(&params, &context), SONJECT_OK);
    assert_int_equal(sonject_scene_read(context, "there is none.yaml", NULL, &none),
                     SONJECT_ERROR_INPUT);
    sonject_scene *scene = make_scene(context);
    snprintf(results, sizeof results, "%s/results", folder);
    run.folder = results;
    if (sonject_run(context, scene, &run, NULL, NULL, NULL) != SONJECT_OK)
        fail_msg("%s", sonject_context_message(context));
    assert_int_equal(sonject_check(context, scene, &text), SONJECT_OK);
    sonject_text_release(&text);
    run.folder = "/proc/nothing/can/be/made/here";
    assert_int_equal(sonject_run(context, scene, &run, NULL, NULL, NULL), SONJECT_ERROR_STORAGE);
    sonject_scene_release(&scene);
    sonject_context_release(&context);
}

/* Sends standard output or error to a file. Returns a descriptor of where it went before. */
static int capture(int descriptor, int file)
{
    const int kept = dup(descriptor);
    assert_true(kept >= 0);
    assert_true(dup2(file, descriptor) >= 0);
    return kept;
}

/* Returns a digest of the run's truth.json, which holds numbers as text. */
static uint64_t digest_of_truth(const char *folder)
{
    char path[TEMPORARY_CAPACITY + 32];
    size_t count;
    snprintf(path, sizeof path, "%s/results/truth.json", folder);
    char *text = (char *)bytes_of_file(path, &count);
    assert_int_equal(strlen(text), count);
    const uint64_t digest = digest_of_text(1, text);
    free(text);
    return digest;
}

static void remove_results(const char *folder)
{
    char path[TEMPORARY_CAPACITY + 16];
    snprintf(path, sizeof path, "%s/results", folder);
    assert_int_equal(remove_folder(path), 0);
}

IN_FOLDER(test_a_host_stays_as_it_was)
{
    struct temporary_folder *folder = *state;
    struct process_state before;
    struct stat said;
    struct opencl opencl = use_opencl();
    read_state(&before);
    work(&opencl, folder->path); /* libraries may keep files open from here on */
    expect_like(&before);
    const uint64_t truth = digest_of_truth(folder->path);
    remove_results(folder->path);
    live_differently(folder->path);
    const int file = open(temporary_file(folder, "said"), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    assert_true(file >= 0);
    fflush(NULL);
    const int output = capture(STDOUT_FILENO, file);
    const int errors = capture(STDERR_FILENO, file);
    read_state(&before);
    work(&opencl, folder->path);
    expect_unchanged(&before);
    assert_true(digest_of_truth(folder->path) == truth);
    remove_results(folder->path);
    (void)fesetround(FE_UPWARD); /* changes the results */
    read_state(&before);
    work(&opencl, folder->path);
    expect_unchanged(&before);
    fflush(NULL);
    assert_true(dup2(output, STDOUT_FILENO) >= 0);
    assert_true(dup2(errors, STDERR_FILENO) >= 0);
    assert_int_equal(fstat(file, &said), 0);
    assert_int_equal(said.st_size, 0);
    (void)fesetround(FE_TONEAREST);
    remove_results(folder->path);
    clReleaseContext(opencl.context);
    close(output);
    close(errors);
    close(file);
    assert_int_equal(chdir("/"), 0);
    (void)setlocale(LC_ALL, "C");
}

TEST_PROGRAM(NULL, NULL)
