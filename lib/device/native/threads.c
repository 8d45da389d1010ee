/* Threads that run launches. The caller runs its launch, too, so that no launch waits for a free
 * thread, and a system without threads is slow but right. */
#include <fenv.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/system/process.h"
#include "device/native/native.h"

#define THREADS_MAX 256
#define SHARES      4 /* a thread takes 1/SHARES of its even share of the rest */

/* A running launch, owned by its caller. */
struct job {
    struct job *next;
    native_function *run;
    const struct kernel_argument *arguments;
    const size_t *global;
    size_t total;
    size_t begun;    /* work-items begun; atomic */
    uint32_t most;   /* threads at once, with the caller */
    uint32_t inside; /* threads of the pool that run the job now */
};

static struct {
    pthread_mutex_t lock;
    pthread_cond_t has_work, has_ended;
    struct job *jobs; /* launches that may have work-items left */
    size_t users;
    uint32_t most;    /* threads besides the callers' */
    uint32_t count;   /* threads started */
    uint32_t waiting; /* threads that wait for a job */
    bool is_ending;
    pthread_t threads[THREADS_MAX];
} pool = {.lock = PTHREAD_MUTEX_INITIALIZER,
          .has_work = PTHREAD_COND_INITIALIZER,
          .has_ended = PTHREAD_COND_INITIALIZER};

/* Takes the next run of work-items. Long runs come first, since each costs a little to begin;
 * single items come last, so that all threads end together. Returns false if all are begun. */
static bool begin_items(struct job *job, size_t *first, size_t *end)
{
    *first = __atomic_load_n(&job->begun, __ATOMIC_RELAXED);
    do {
        if (*first >= job->total)
            return false;
        const size_t share = (job->total - *first) / (SHARES * (size_t)job->most);
        *end = *first + (share > 1 ? share : 1);
    } while (!__atomic_compare_exchange_n(&job->begun, first, *end, true, __ATOMIC_RELAXED,
                                          __ATOMIC_RELAXED));
    return true;
}

/* Runs items in the default floating-point environment: whatever a host does to its threads'
 * rounding or denormal numbers, kernels give the same bits. */
static void run_items(void *job_to_run)
{
    struct job *job = job_to_run;
    size_t first, end;
    fenv_t before;
    fegetenv(&before);
    fesetenv(FE_DFL_ENV);
    fesetround(FE_TONEAREST); /* Wine's default environment keeps the host's rounding */
    while (begin_items(job, &first, &end))
        job->run(job->arguments, job->global, first, end);
    fesetenv(&before);
}

/* Returns a job that wants one thread more; NULL if none does. Needs the lock. */
static struct job *find_job(void)
{
    struct job *job = pool.jobs;
    while (job && (job->inside + 1 >= job->most ||
                   __atomic_load_n(&job->begun, __ATOMIC_RELAXED) >= job->total))
        job = job->next;
    return job;
}

static void *serve(void *unused)
{
    pthread_mutex_lock(&pool.lock);
    while (!pool.is_ending) {
        struct job *job = find_job();
        if (!job) {
            pool.waiting++;
            pthread_cond_wait(&pool.has_work, &pool.lock);
            pool.waiting--;
            continue;
        }
        job->inside++;
        pthread_mutex_unlock(&pool.lock);
        run_items(job);
        pthread_mutex_lock(&pool.lock);
        job->inside--;
        pthread_cond_broadcast(&pool.has_ended);
    }
    pthread_mutex_unlock(&pool.lock);
    return unused;
}

/* Empties the pool in a forked child, which has none of the parent's threads and launches. The lock
 * is made again, because a thread may have held it during the fork. */
static void begin_child(void)
{
    pthread_mutex_init(&pool.lock, NULL);
    pthread_cond_init(&pool.has_work, NULL);
    pthread_cond_init(&pool.has_ended, NULL);
    pool.jobs = NULL;
    pool.count = pool.waiting = 0;
    pool.is_ending = false;
}

static void watch_forks(void)
{
    forks_watch(begin_child);
}

void threads_retain(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, watch_forks);
    pthread_mutex_lock(&pool.lock);
    if (pool.users++ == 0)
        pool.most = processor_count() < THREADS_MAX ? processor_count() - 1 : THREADS_MAX;
    pthread_mutex_unlock(&pool.lock);
}

void threads_release(void)
{
    uint32_t count = 0;
    pthread_t ended[THREADS_MAX];
    pthread_mutex_lock(&pool.lock);
    if (--pool.users == 0 && !pool.is_ending) {
        count = pool.count;
        memcpy(ended, pool.threads, count * sizeof *ended);
        pool.is_ending = count > 0;
        pthread_cond_broadcast(&pool.has_work);
    }
    pthread_mutex_unlock(&pool.lock);
    for (uint32_t i = 0; i < count; i++)
        pthread_join(ended[i], NULL);
    if (count == 0)
        return;
    pthread_mutex_lock(&pool.lock);
    pool.count = 0;
    pool.is_ending = false;
    pthread_mutex_unlock(&pool.lock);
}

/* Starts threads for a job while too few are waiting. Needs the lock. */
static void start_threads(uint32_t wanted)
{
    while (!pool.is_ending && pool.waiting < wanted && pool.count < pool.most &&
           thread_start(&pool.threads[pool.count], serve, NULL)) {
        pool.count++;
        wanted--;
    }
}

static struct job make_job(uint32_t most, native_function *run,
                           const struct kernel_argument *arguments, const size_t global[3])
{
    return (struct job){.run = run,
                        .arguments = arguments,
                        .global = global,
                        .total = global[0] * global[1] * global[2],
                        .most = most};
}

void threads_run_by_host(sonject_run_tasks_function run_tasks, void *user, uint32_t most,
                         native_function *run, const struct kernel_argument *arguments,
                         const size_t global[3])
{
    struct job job = make_job(most, run, arguments, global);
    if (most > 1 && job.total > 1)
        run_tasks(user, job.total < most ? (uint32_t)job.total : most, run_items, &job);
    run_items(&job);
}

void threads_run(uint32_t most, native_function *run, const struct kernel_argument *arguments,
                 const size_t global[3])
{
    struct job job = make_job(most, run, arguments, global);
    struct job **link = &pool.jobs;
    if (most <= 1 || job.total <= 1) {
        run_items(&job);
        return;
    }
    pthread_mutex_lock(&pool.lock);
    job.next = pool.jobs;
    pool.jobs = &job;
    start_threads(most - 1);
    pthread_cond_broadcast(&pool.has_work);
    pthread_mutex_unlock(&pool.lock);
    run_items(&job);
    pthread_mutex_lock(&pool.lock);
    while (*link != &job)
        link = &(*link)->next;
    *link = job.next;
    while (job.inside > 0)
        pthread_cond_wait(&pool.has_ended, &pool.lock);
    pthread_mutex_unlock(&pool.lock);
}
