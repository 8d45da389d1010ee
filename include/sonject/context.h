/* A context: one device, its programs, and the message of the last failure. */
#ifndef SONJECT_CONTEXT_H
#define SONJECT_CONTEXT_H

#include <stddef.h>
#include <stdint.h>

#include <sonject/export.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

typedef struct sonject_context sonject_context;

/* The kind of a line of the log. */
typedef enum sonject_log_level {
    SONJECT_LOG_NEWS = 0, /* progress of the work, for those who ask for it */
    SONJECT_LOG_NOTE = 1  /* a fact that users of the result must know; always show it */
} sonject_log_level;

/* Receives one line of the log, without a newline at its end. level: a sonject_log_level. It is
 * called on the thread that made the call. */
typedef void (*sonject_log_function)(void *user, uint32_t level, const char *line);

/* Receives the finished fraction, 0...1, between pieces of work and while a driver compiles. Return
 * 0 to continue, anything else to cancel: the call then returns SONJECT_CANCELLED. A call that
 * succeeds reports 1 at its end, when nothing is left to cancel. */
typedef int (*sonject_progress_function)(void *user, double fraction, const char *stage);

/* The host's own threads. The function calls task(argument) up to `count` times at once, on some of
 * these threads or on its caller's, and returns when all calls have ended. A task ends when no work
 * is left, so fewer calls than `count` do the same work. Several threads may call the function at
 * once. */
typedef void (*sonject_task_function)(void *argument);
typedef void (*sonject_run_tasks_function)(void *user, uint32_t count, sonject_task_function task,
                                           void *argument);

/* The options of a context. All 0: the default device, silent. In every structure of parameters, a
 * member that is 0 stands for its default: `sonject_run_params params = {.struct_size = sizeof
 * params, .folder = "out"};` is complete. */
typedef struct sonject_context_params {
    uint32_t struct_size;    /* sizeof(sonject_context_params) */
    uint32_t reserved;       /* 0 */
    const char *device_name; /* part of a device's name, case-insensitive; NULL: the device named by
                                the environment's SONJECT_DEVICE, else an OpenCL GPU, else native:
                                this processor, which needs no driver */
    sonject_log_function log; /* NULL: silent */
    void *log_user;
    uint32_t decodes_in_process; /* 0: a child process, the program sonject-decoder, reads images,
                                    HDF5 and MATLAB v7.3 files, so that a file that crashes a
                                    library fails only the call; 1: this process reads them, for
                                    hosts that must not start others */
    uint32_t threads;            /* processors that a launch uses on the device native; 0: all */
    sonject_run_tasks_function run_tasks; /* runs the launches of the device native; NULL: threads
                                             of the library's own */
    void *run_tasks_user;
} sonject_context_params;

/* Makes a context. The first call that needs a device opens it, so that a missing device is
 * reported with a message. params may be NULL (all defaults); its strings are copied.
 * On success *context is the caller's, for sonject_context_release; on failure it is NULL. Errors:
 * ARGUMENT, MEMORY.
 * Threads: a context and everything made with it belong to one thread at a time. Several threads
 * may use different contexts at once, even for the first use of a device.
 * Contexts of one device share its compiled kernels, which the last of them releases. The device
 * native keeps up to 96 MB of buffers for later calls, until a context is released.
 * Forks: the device native works in child processes, also with contexts that were made before the
 * fork. OpenCL does not work in a child of a process that used it (by opening a device that was not
 * named native, or by listing devices). There the default is native, and other devices answer
 * ERROR_DEVICE.
 * The program sonject-decoder is started if a call needs it. It has no descriptors but its own,
 * ends with the context or this process, and is started again if a file crashed it. It is looked
 * for in the folder sonject beside the library (or beside a program that contains the library), in
 * the folder of either, and where sonject was installed. */
SONJECT_API sonject_status sonject_context_create(const sonject_context_params *params,
                                                  sonject_context **context);

/* Releases the context and sets *context to NULL. NULL and a pointer to NULL are allowed. Release
 * everything made with the context first. */
SONJECT_API void sonject_context_release(sonject_context **context);

/* Returns the message of the last failed call on this context, "" if none failed. It names what is
 * wrong and where, in one line. For a scene or campaign file it has a line for each mistake, in the
 * order of the file ("file:line:column: key: ..."), at most 50, then "and N more". The last line
 * has no newline. Valid until the next call on the context. */
SONJECT_API const char *sonject_context_message(const sonject_context *context);

/* The properties of a device. */
typedef struct sonject_device_info {
    char name[128];
    char platform[128];
    char driver[128];
    uint32_t compute_units;
    uint32_t vector_width; /* lanes that the kernels are compiled for */
    uint32_t is_default;   /* 1 for the device of a context that names none */
    uint32_t reserved;
} sonject_device_info;

/* Lists the devices: native, then those of OpenCL. devices: room for capacity entries (NULL if
 * capacity is 0). *count gets the number found, which may exceed capacity. If OpenCL cannot be
 * asked, the log says why. Errors: ARGUMENT, MEMORY. */
SONJECT_API sonject_status sonject_devices(sonject_context *context, sonject_device_info *devices,
                                           size_t capacity, size_t *count);

SONJECT_END_DECLARATIONS

#endif
