/* Compiling takes a driver seconds, on slow machines minutes, and shows no progress. So a thread of
 * its own compiles, while the caller's tells what it waits for, and for how long. */
#include <pthread.h>
#include <stdio.h>

#include "base/system/process.h"
#include "device/opencl/opencl.h"

struct waited_for {
    void (*compile)(void *user);
    void *user;
    pthread_mutex_t lock;
    pthread_cond_t ended;
    bool has_ended;
};

static void *do_compile(void *user)
{
    struct waited_for *waited_for = user;
    waited_for->compile(waited_for->user);
    pthread_mutex_lock(&waited_for->lock);
    waited_for->has_ended = true;
    pthread_cond_signal(&waited_for->ended);
    pthread_mutex_unlock(&waited_for->lock);
    return NULL;
}

sonject_status wait_for_compiler(struct report *report, void (*compile)(void *user), void *user)
{
    struct waited_for waited_for = {compile, user, PTHREAD_MUTEX_INITIALIZER,
                                    PTHREAD_COND_INITIALIZER, false};
    const double start_s = clock_seconds();
    bool is_cancelled = false;
    pthread_t thread;
    if (!thread_start(&thread, do_compile, &waited_for)) {
        compile(user);
        return SONJECT_OK;
    }
    pthread_mutex_lock(&waited_for.lock);
    while (!waited_for.has_ended) {
        const double waited_s = clock_seconds() - start_s;
        char stage[32];
        snprintf(stage, sizeof stage, "compiling, once: %.0f s", waited_s);
        pthread_mutex_unlock(&waited_for.lock);
        if (waited_s > 0.5) /* less: it was compiled before */
            is_cancelled = report_is_cancelled(report, stage) || is_cancelled;
        pthread_mutex_lock(&waited_for.lock);
        if (!waited_for.has_ended)
            wait_a_little(&waited_for.ended, &waited_for.lock);
    }
    pthread_mutex_unlock(&waited_for.lock);
    pthread_join(thread, NULL);
    return is_cancelled ? report_failure(report, SONJECT_CANCELLED, "cancelled") : SONJECT_OK;
}
