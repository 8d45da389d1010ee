#define _POSIX_C_SOURCE 200809L /* for clock_gettime */
#include <time.h>

#include "base/system/process.h"

void wait_a_little(pthread_cond_t *condition, pthread_mutex_t *lock)
{
    struct timespec end;
    clock_gettime(CLOCK_REALTIME, &end);
    end.tv_nsec += 200000000;
    end.tv_sec += end.tv_nsec / 1000000000;
    end.tv_nsec %= 1000000000;
    pthread_cond_timedwait(condition, lock, &end);
}
