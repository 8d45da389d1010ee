/* The threads that run launches (threads.c), for this folder's files. */
#ifndef SONJECT_DEVICE_NATIVE_NATIVE_H
#define SONJECT_DEVICE_NATIVE_NATIVE_H

#include <stddef.h>
#include <stdint.h>

#include <sonject/context.h>

#include "device/native/kernel.h"

/* Counts the devices that use the threads of this process, which end with the last one. */
void threads_retain(void);
void threads_release(void);

/* Runs work-items on the calling thread and on up to most - 1 others, and waits for all. Any
 * threads may call this at once and share the process's threads. A forked child starts its own. */
void threads_run(uint32_t most, native_function *run, const struct kernel_argument *arguments,
                 const size_t global[3]);

/* Runs work-items in the same way on a host's threads. */
void threads_run_by_host(sonject_run_tasks_function run_tasks, void *user, uint32_t most,
                         native_function *run, const struct kernel_argument *arguments,
                         const size_t global[3]);

#endif
