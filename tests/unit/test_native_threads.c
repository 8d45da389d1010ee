/* Tests launches on the native device: each work-item runs once, whoever else launches. */
#include "claims.h"

#include <fenv.h>
#include <pthread.h>
#include <sched.h>
#ifdef HAS_POSIX
#include <sys/wait.h>
#endif
#include <time.h>
#include <unistd.h>

#include "base/system/process.h"
#include "device/native/native.h"

#define HOSTS    4
#define LAUNCHES 50
#define ITEMS    1200
#define FORKS    60
#define SECONDS  60 /* s, after which a child that hangs is ended */

/* Counts each work-item in a buffer, and calls at another rounding than the default. */
static void count(const struct kernel_argument *arguments, const size_t *global, size_t first,
                  size_t end)
{
    int *counts = *(int *const *)arguments[0].value;
    int *rounded = *(int *const *)arguments[1].value;
    static const struct timespec moment = {0, 20000};
    (void)global;
    nanosleep(&moment, NULL); /* shows a launch that does not wait for its threads */
    for (size_t i = first; i < end; i++)
        counts[i]++;
    if (fegetround() != FE_TONEAREST)
        __atomic_add_fetch(rounded, 1, __ATOMIC_RELAXED);
}

/* A host's threads: as many as asked for, as many as the host has time for, or none. */
struct task_host {
    uint32_t threads_max;
    uint32_t asked, started; /* atomic */
};

struct task {
    sonject_task_function run;
    void *argument;
};

static void *run_task(void *task_to_run)
{
    const struct task *task = task_to_run;
    task->run(task->argument);
    return NULL;
}

static void run_tasks(void *user, uint32_t wanted, sonject_task_function run, void *argument)
{
    struct task_host *host = user;
    struct task task = {run, argument};
    pthread_t threads[HOSTS];
    const uint32_t started = wanted < host->threads_max ? wanted : host->threads_max;
    host->asked = wanted;
    for (uint32_t i = 0; i < started; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, run_task, &task), 0);
    for (uint32_t i = 0; i < started; i++)
        pthread_join(threads[i], NULL);
    host->started += started;
}

/* Opens, launches and closes. Returns whether all was as it should be. by: a host's threads; NULL:
 * the library's. */
static bool launch_by(struct task_host *by, uint32_t most, size_t items)
{
    static const size_t rest[2] = {3, 2};
    int *counts = zeroed(items * 6, sizeof *counts), rounding = 0;
    int *rounded = &rounding;
    const size_t global[3] = {items, rest[0], rest[1]};
    const struct kernel_argument arguments[] = {ARGUMENT(counts), ARGUMENT(rounded)};
    threads_retain();
    if (by)
        threads_run_by_host(run_tasks, by, most, count, arguments, global);
    else
        threads_run(most, count, arguments, global);
    threads_release();
    bool is_right = rounding == 0;
    for (size_t i = 0; i < items * 6; i++)
        is_right = is_right && counts[i] == 1;
    free(counts);
    return is_right;
}

static bool launch(uint32_t most, size_t items)
{
    return launch_by(NULL, most, items);
}

TEST(test_a_hosts_threads_run_each_work_item_once)
{
    for (uint32_t threads = 0; threads <= HOSTS; threads++) {
        struct task_host by = {.threads_max = threads};
        for (uint32_t most = 2; most <= 6; most++) {
            assert_true(launch_by(&by, most, 40));
            assert_int_equal(by.asked, most);
        }
        assert_true((by.started > 0) == (threads > 0));
        by.asked = 0;
        assert_true(launch_by(&by, 1, 40));
        assert_int_equal(by.asked, 0);
        assert_true(launch_by(&by, 60, 1)); /* 6 work-items with the other sides */
        assert_int_equal(by.asked, 6);
    }
}

static void *host(void *is_right)
{
    *(bool *)is_right = true;
    for (uint32_t i = 0; i < LAUNCHES; i++)
        *(bool *)is_right &= launch(1 + i % 6, 1 + i * 7 % (ITEMS / 6));
    return NULL;
}

TEST(test_each_work_item_runs_once_beside_other_hosts)
{
    pthread_t threads[HOSTS];
    bool are_right[HOSTS];
    for (int i = 0; i < HOSTS; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, host, &are_right[i]), 0);
    for (int i = 0; i < HOSTS; i++)
        pthread_join(threads[i], NULL);
    for (int i = 0; i < HOSTS; i++)
        assert_true(are_right[i]);
}

/* Locks of sanitizers, and of QEMU, do not survive the fork. */
#if defined HAS_POSIX && !defined IS_SANITIZED && !defined IS_EMULATED
/* Lets two work-items wait for each other, and so for a second thread. */
static void meet(const struct kernel_argument *arguments, const size_t *global, size_t first,
                 size_t end)
{
    static int here;
    (void)arguments, (void)global, (void)first, (void)end;
    __atomic_add_fetch(&here, 1, __ATOMIC_SEQ_CST);
    while (__atomic_load_n(&here, __ATOMIC_SEQ_CST) < 2)
        sched_yield();
}

/* Children are forked while other threads launch. */
TEST(test_children_have_threads_of_their_own)
{
    pthread_t threads[HOSTS];
    bool are_right[HOSTS];
    for (int i = 0; i < HOSTS; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, host, &are_right[i]), 0);
    for (int i = 0; i < FORKS; i++) {
        static const size_t two[3] = {2, 1, 1};
        int status = 0;
        const pid_t child = fork();
        if (child == 0) {
            alarm(SECONDS);
            threads_retain();
            if (processor_count() > 1)
                threads_run(2, meet, NULL, two);
            threads_release();
            _exit(launch(4, 20) ? 0 : 1);
        }
        assert_true(child > 0 && waitpid(child, &status, 0) == child);
        assert_int_equal(status, 0);
    }
    for (int i = 0; i < HOSTS; i++)
        pthread_join(threads[i], NULL);
}
#endif

TEST(test_a_hosts_rounding_is_set_aside_and_given_back)
{
    assert_int_equal(fesetround(FE_UPWARD), 0);
    for (uint32_t most = 1; most <= 4; most++)
        assert_true(launch(most, 50));
    assert_int_equal(fegetround(), FE_UPWARD);
    assert_int_equal(fesetround(FE_TONEAREST), 0);
}

TEST_PROGRAM(NULL, NULL)
