#define _POSIX_C_SOURCE 200809L
#include "cl/driver.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"

static pid_t process_of_driver; /* 0: no call was made yet; atomic */
static pthread_mutex_t one_at_a_time = PTHREAD_MUTEX_INITIALIZER;
static struct shared_device *devices_in_use;

/* The process is noted before the lock is taken, so that no child waits for one that a thread of
 * its parent held. */
sonject_status driver_claim(struct report *report)
{
    pid_t first = 0;
    const pid_t process = getpid();
    if (__atomic_compare_exchange_n(&process_of_driver, &first, process, false, __ATOMIC_SEQ_CST,
                                    __ATOMIC_SEQ_CST) ||
        first == process)
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_DEVICE,
                          "OpenCL was in use when this process was forked, and its calls would "
                          "wait for ever: start a new process instead (in Python, spawn it), or "
                          "fork before OpenCL is used");
}

bool driver_is_inherited(void)
{
    const pid_t first = __atomic_load_n(&process_of_driver, __ATOMIC_SEQ_CST);
    return first != 0 && first != getpid();
}

sonject_status driver_enter(struct report *report)
{
    const sonject_status status = driver_claim(report);
    if (status == SONJECT_OK)
        pthread_mutex_lock(&one_at_a_time);
    return status;
}

void driver_leave(void)
{
    pthread_mutex_unlock(&one_at_a_time);
}

struct shared_device *shared_device_find(cl_device_id id, cl_context host_context, cl_int *error)
{
    *error = CL_SUCCESS;
    struct shared_device *device = devices_in_use;
    while (device && (device->id != id || device->host_context != host_context))
        device = device->next;
    if (!device) {
        device = allocate_array(1, sizeof *device);
        if (!device) {
            *error = CL_OUT_OF_HOST_MEMORY;
            return NULL;
        }
        if (host_context)
            *error = clRetainContext(host_context);
        else
            device->context = clCreateContext(NULL, 1, &id, NULL, NULL, error);
        if (*error != CL_SUCCESS) {
            free(device);
            return NULL;
        }
        device->id = id;
        if (host_context)
            device->context = device->host_context = host_context;
        device->next = devices_in_use;
        devices_in_use = device;
    }
    device->users++;
    return device;
}

void shared_device_release(struct shared_device *device)
{
    if (--device->users > 0)
        return;
    struct shared_device **link = &devices_in_use;
    while (*link != device)
        link = &(*link)->next;
    *link = device->next;
    for (size_t i = 0; i < device->program_count; i++)
        clReleaseProgram(device->programs[i].program);
    clReleaseContext(device->context);
    free(device);
}

static void put_first(struct shared_device *device, size_t place, const struct kept_program *kept)
{
    memmove(device->programs + 1, device->programs, place * sizeof *device->programs);
    device->programs[0] = *kept;
}

cl_program shared_program_find(struct shared_device *device, const char *key)
{
    for (size_t i = 0; i < device->program_count; i++) {
        const struct kept_program kept = device->programs[i];
        if (strcmp(kept.key, key) == 0) {
            put_first(device, i, &kept);
            return kept.program;
        }
    }
    return NULL;
}

void shared_program_keep(struct shared_device *device, const char *key, cl_program program)
{
    struct kept_program kept = {program, ""};
    memcpy(kept.key, key, sizeof kept.key);
    if (device->program_count == PROGRAMS_KEPT)
        clReleaseProgram(device->programs[--device->program_count].program);
    put_first(device, device->program_count++, &kept);
}
