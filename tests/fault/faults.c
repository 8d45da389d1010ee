#include "faults.h"

#include <pthread.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER; /* guards all shared variables */
static enum fault_kind armed_kind;
static bool is_armed, does_stay;
static long due, calls, blocks, objects;
static int chosen_error;

static __thread bool arms_libraries;
static __thread int looks_away;

void fault_arm(enum fault_kind kind, long n, bool stays, int error)
{
    pthread_mutex_lock(&lock);
    armed_kind = kind;
    is_armed = true;
    does_stay = stays;
    due = n;
    calls = 0;
    chosen_error = error;
    pthread_mutex_unlock(&lock);
    arms_libraries = kind == FAULT_LIBRARIES;
}

long fault_disarm(void)
{
    arms_libraries = false;
    pthread_mutex_lock(&lock);
    const long count = calls;
    is_armed = false;
    pthread_mutex_unlock(&lock);
    return count;
}

bool fault_is_due(enum fault_kind kind, int *error)
{
    pthread_mutex_lock(&lock);
    const bool counts = is_armed && kind == armed_kind;
    if (counts)
        calls++;
    const bool is_due = counts && due > 0 && (calls == due || (does_stay && calls > due));
    *error = chosen_error;
    pthread_mutex_unlock(&lock);
    return is_due;
}

void fault_look_away(void)
{
    looks_away++;
}

void fault_look_again(void)
{
    looks_away--;
}

bool fault_is_watched(void)
{
    return arms_libraries && looks_away == 0;
}

static long read_count(const long *count)
{
    pthread_mutex_lock(&lock);
    const long value = *count;
    pthread_mutex_unlock(&lock);
    return value;
}

static void change_count(long *count, long change)
{
    pthread_mutex_lock(&lock);
    *count += change;
    pthread_mutex_unlock(&lock);
}

long fault_blocks(void)
{
    return read_count(&blocks);
}

long fault_objects(void)
{
    return read_count(&objects);
}

void fault_count_block(long change)
{
    change_count(&blocks, change);
}

void fault_count_object(long change)
{
    change_count(&objects, change);
}
