/* Tests the first use of a device in a process, by several threads, and before and after a fork.
 * Tests what contexts hold, and that two threads, each with a context of its own, make the images
 * that one makes. This process makes no call of the library, so that each of its children is the
 * first to use the driver. */
#include "claims.h"

#include <pthread.h>
#include <sys/wait.h>
#include <unistd.h>

#include <sonject/sonject.h>

#define THREADS  4
#define CONTEXTS 100
#ifndef RUNS
#define RUNS 8 /* number of processes; a slow checker may be compiled with fewer */
#endif
#define SECONDS     300             /* s, after which a child that hangs is ended */
#define IMAGES      (2 * RUNS + 10) /* number of images of each of two threads */
#define SIDE        24
#define KINDS       3 /* different scenes, which a thread takes in turn */
#define IMAGE_BYTES (SIDE * SIDE * sizeof(float))

/* The work of a child of this process, or of a child's child. Returns nonzero for failure. */
typedef int child_work(void);

static int say(const char *what, const sonject_context *context)
{
    fprintf(stderr, "%s: %s\n", what, context ? sonject_context_message(context) : "");
    return 1;
}

static int exit_of(child_work *work)
{
    int status = 0;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        alarm(SECONDS);
        _exit(work());
    }
    return child > 0 && waitpid(child, &status, 0) == child ? status : -1;
}

/* Injects a sphere, whose glint is weak, or a cylinder, elsewhere by kind. pixels may be NULL. */
static sonject_status inject_kind(sonject_context *context, unsigned kind, float *pixels)
{
    sonject_scene *scene = NULL;
    sonject_result *result = NULL;
    char text[500];
    const sonject_scene_read_params params = {.struct_size = sizeof params, .text = text};
    snprintf(text, sizeof text,
             "sonject: 1\n"
             "input: {uniform: {rows: %d, columns: %d}, geometry: {row_spacing: 0.06,\n"
             "  column_spacing: 0.06, first_slant_range: %u}}\n"
             "sonar: {frequency: 100e3, bandwidth: 15e3, altitude: 8}\n"
             "injection: {seed: %u}\n"
             "objects: [{shape: %s, diameter: 0.3}]\n",
             SIDE, SIDE, 20 + kind, 7 + kind, kind == 1 ? "cylinder, length: 0.5" : "sphere");
    sonject_status status = sonject_scene_read(context, NULL, &params, &scene);
    if (status == SONJECT_OK)
        status = sonject_inject(context, scene, NULL, NULL, NULL, &result);
    if (status == SONJECT_OK && pixels)
        status = sonject_result_layer(result, SONJECT_LAYER_IMAGE, pixels, IMAGE_BYTES);
    sonject_result_release(&result);
    sonject_scene_release(&scene);
    return status;
}

static sonject_status inject(sonject_context *context)
{
    return inject_kind(context, 0, NULL);
}

static int inject_once(void)
{
    sonject_context *context = NULL;
    int failed = sonject_context_create(NULL, &context) != SONJECT_OK;
    if (!failed && inject(context) != SONJECT_OK)
        failed = say("inject", context);
    sonject_context_release(&context);
    return failed;
}

static pthread_barrier_t all_are_there;

static void *inject_in_thread(void *failed)
{
    pthread_barrier_wait(&all_are_there);
    *(int *)failed = inject_once();
    return NULL;
}

static int inject_together(void)
{
    pthread_t threads[THREADS];
    int failed[THREADS];
    int failures = 0;
    pthread_barrier_init(&all_are_there, NULL, THREADS);
    for (int i = 0; i < THREADS; i++)
        if (pthread_create(&threads[i], NULL, inject_in_thread, &failed[i]) != 0)
            return say("no thread", NULL);
    for (int i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        failures += failed[i];
    }
    return failures;
}

TEST(test_threads_may_be_the_first_to_use_a_device)
{
    for (int run = 0; run < RUNS; run++)
        assert_int_equal(exit_of(inject_together), 0);
}

static sonject_context *parents;

/* Returns 0 if the call was refused with the reason, else 1. */
static int is_let_in(const char *what, sonject_context *context, sonject_status status)
{
    return status != SONJECT_ERROR_DEVICE || !strstr(sonject_context_message(context), "forked")
               ? say(what, context)
               : 0;
}

static const sonject_context_params on_pocl = {.struct_size = sizeof on_pocl,
                                               .device_name = "pthread"};
static const sonject_context_params on_native = {.struct_size = sizeof on_native,
                                                 .device_name = "native"};

/* Expects a child to be refused OpenCL, but not the native device. */
static int expect_refusal(void)
{
    size_t count = 0;
    sonject_context *own = NULL, *native = NULL;
    if (sonject_context_create(&on_pocl, &own) != SONJECT_OK ||
        sonject_context_create(&on_native, &native) != SONJECT_OK)
        return 1;
    int failures = is_let_in("the parent's context", parents, inject(parents)) +
                   is_let_in("a context of the child's", own, inject(own));
    if (sonject_devices(own, NULL, 0, &count) != SONJECT_OK || count != 1)
        failures += say("devices", own);
    if (inject(native) != SONJECT_OK)
        failures += say("native", native);
    sonject_context_release(&own);
    sonject_context_release(&native);
    sonject_context_release(&parents);
    return failures;
}

/* Forks after the parent has used or only listed the device. The parent goes on with the device. */
static int fork_after(sonject_status (*use)(sonject_context *context))
{
    if (sonject_context_create(&on_pocl, &parents) != SONJECT_OK || use(parents) != SONJECT_OK)
        return say("parent", parents);
    if (exit_of(expect_refusal) != 0)
        return say("child", NULL);
    const int failed = inject(parents) != SONJECT_OK ? say("parent, afterwards", parents) : 0;
    sonject_context_release(&parents);
    return failed;
}

static sonject_status list(sonject_context *context)
{
    size_t count;
    return sonject_devices(context, NULL, 0, &count);
}

static int fork_after_injecting(void)
{
    return fork_after(inject);
}

static int fork_after_listing(void)
{
    return fork_after(list);
}

TEST(test_a_child_of_a_process_that_used_opencl_is_refused)
{
    assert_int_equal(exit_of(fork_after_injecting), 0);
    assert_int_equal(exit_of(fork_after_listing), 0);
}

static int inject_in_parents(void)
{
    const int failed = inject(parents) != SONJECT_OK ? say("child", parents) : 0;
    sonject_context_release(&parents);
    return failed;
}

/* Forks on the native device. A child does not have the threads of its parent's launches. */
static int fork_native(void)
{
    if (sonject_context_create(&on_native, &parents) != SONJECT_OK || inject(parents) != SONJECT_OK)
        return say("parent", parents);
    for (int run = 0; run < RUNS; run++)
        if (exit_of(inject_in_parents) != 0)
            return say("child", NULL);
    return inject_in_parents();
}

TEST(test_children_inject_on_native_as_their_parent_does)
{
    assert_int_equal(exit_of(fork_native), 0);
}

/* Forks after a context was made that opened no device, so that both processes may use one. */
static int fork_before_injecting(void)
{
    if (sonject_context_create(NULL, &parents) != SONJECT_OK)
        return 1;
    const int failed = exit_of(inject_in_parents) != 0 || exit_of(inject_once) != 0;
    return failed + inject_in_parents();
}

TEST(test_parent_and_child_may_both_inject_where_none_did_before)
{
    assert_int_equal(exit_of(fork_before_injecting), 0);
}

/* Returns the resident memory of this process, in pages. */
static long pages(void)
{
    long all, resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%ld %ld", &all, &resident) != 2)
        resident = 0;
    if (file)
        fclose(file);
    return resident;
}

static int hold_contexts(void)
{
    sonject_context *contexts[CONTEXTS] = {NULL};
    long before = 0, after_one = 0;
    int failed = 0;
    for (int i = 0; i < CONTEXTS && !failed; i++) {
        before = i == 0 ? pages() : before;
        failed = sonject_context_create(NULL, &contexts[i]) != SONJECT_OK ||
                 inject(contexts[i]) != SONJECT_OK;
        after_one = i == 0 ? pages() : after_one;
    }
    const long after_all = pages();
    for (int i = 0; i < CONTEXTS; i++)
        sonject_context_release(&contexts[i]);
    fprintf(stderr, "one context %ld pages, %d more %ld\n", after_one - before, CONTEXTS - 1,
            after_all - after_one);
    return failed || after_all - after_one > after_one - before ? say("contexts hold much", NULL)
                                                                : 0;
}

TEST(test_a_hundred_contexts_hold_less_than_two)
{
    if (pages() == 0)
        skip();
    assert_int_equal(exit_of(hold_contexts), 0);
}

struct worker {
    float (*expected)[SIDE * SIDE]; /* image of each kind */
    unsigned first_kind;
    int failed;
};

static void *repeat_images(void *argument)
{
    struct worker *worker = argument;
    sonject_context *context = NULL;
    float pixels[SIDE * SIDE];
    worker->failed = sonject_context_create(NULL, &context) != SONJECT_OK;
    for (unsigned run = 0; !worker->failed && run < IMAGES; run++) {
        const unsigned kind = (worker->first_kind + run) % KINDS;
        if (inject_kind(context, kind, pixels) != SONJECT_OK)
            worker->failed = say("thread", context);
        else if (memcmp(pixels, worker->expected[kind], IMAGE_BYTES) != 0)
            worker->failed = say("another image", NULL);
    }
    sonject_context_release(&context);
    return NULL;
}

static int inject_side_by_side(void)
{
    static float expected[KINDS][SIDE * SIDE];
    struct worker workers[2] = {{expected, 0, 0}, {expected, 1, 0}};
    pthread_t threads[2];
    sonject_context *context = NULL;
    int failed = sonject_context_create(NULL, &context) != SONJECT_OK;
    for (unsigned kind = 0; kind < KINDS && !failed; kind++)
        failed = inject_kind(context, kind, expected[kind]) != SONJECT_OK;
    sonject_context_release(&context);
    if (failed || memcmp(expected[0], expected[1], IMAGE_BYTES) == 0)
        return say("one thread", NULL);
    for (int i = 0; i < 2; i++)
        if (pthread_create(&threads[i], NULL, repeat_images, &workers[i]) != 0)
            return say("no thread", NULL);
    for (int i = 0; i < 2; i++) {
        pthread_join(threads[i], NULL);
        failed += workers[i].failed;
    }
    return failed;
}

TEST(test_two_threads_give_what_one_gives)
{
    assert_int_equal(exit_of(inject_side_by_side), 0);
}

TEST_PROGRAM(NULL, NULL)
