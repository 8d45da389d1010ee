/* A context: one device, its programs, and the message of the last failure. */
#ifndef SONJECT_CONTEXT_H
#define SONJECT_CONTEXT_H

#include <stddef.h>
#include <stdint.h>

#include <sonject/export.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

typedef struct sonject_context sonject_context;

/* What a line of the log is. */
typedef enum sonject_log_level {
    SONJECT_LOG_NEWS = 0, /* what is done, for who asks */
    SONJECT_LOG_NOTE = 1  /* what who uses the result must know: show it always */
} sonject_log_level;

/* Receives one line (no newline at its end) of a sonject_log_level; called on the thread that made
 * the call. */
typedef void (*sonject_log_function)(void *user, uint32_t level, const char *line);

/* Called between pieces of work, and while a driver compiles, with the finished fraction, 0...1.
 * Return 0 to go on, anything else to cancel: the call then answers SONJECT_CANCELLED. A call that
 * succeeds tells 1 at its end, when nothing is left to cancel. */
typedef int (*sonject_progress_function)(void *user, double fraction, const char *stage);

/* A host's threads: calls task(argument) on some of them, or on the caller's, up to `count` times
 * at once, and returns when all these calls have ended. A call ends when nothing is left to do, so
 * that fewer calls than count do the same. Several threads may ask at once. */
typedef void (*sonject_task_function)(void *argument);
typedef void (*sonject_run_tasks_function)(void *user, uint32_t count, sonject_task_function task,
                                           void *argument);

/* All 0: the default device, silent. Of every structure of parameters: members that are 0 stand for
 * their defaults, so that `sonject_run_params params = {.struct_size = sizeof params, .folder =
 * "out"};` is complete. */
typedef struct sonject_context_params {
    uint32_t struct_size;     /* sizeof(sonject_context_params) */
    uint32_t reserved;        /* 0 */
    const char *device_name;  /* part of a device's name, case-insensitive; NULL: what the
                                 environment's SONJECT_DEVICE names, else a GPU of OpenCL, else
                                 native: this processor, which needs no driver */
    sonject_log_function log; /* NULL: silent */
    void *log_user;
    uint32_t decodes_in_process; /* 0: images, HDF5 and MATLAB v7.3 files are read by a child
                                    process, the program sonject-decoder, so that one that ends a
                                    library ends only a call; 1: in this process, for hosts that may
                                    not start others */
    uint32_t threads;            /* that a launch takes of the processors, on the device native; 0:
                                    as many as there are */
    sonject_run_tasks_function run_tasks; /* that runs the device native's launches; NULL: threads
                                             of the library's own */
    void *run_tasks_user;
} sonject_context_params;

/* Makes a context. It opens no device yet: that happens at the first call that needs one, so that a
 * missing device is reported with a message. params may be NULL (all defaults); its strings are
 * copied.
 * On success *context is the caller's, to be given to sonject_context_release. On failure *context
 * is NULL. Errors: ARGUMENT, MEMORY.
 * Threads: a context and whatever was made with it belong to one thread at a time; different
 * contexts may be used by different threads at once, also when these are the first to use a
 * device.
 * Contexts of one device share what is compiled for it, which is given back with the last of them.
 * The device native keeps up to 96 MB of buffers for later calls, until a context is released.
 * Forks: the device native works in children, also with contexts that were made before. OpenCL does
 * not, in a child of a process in which a call asked for it (one that opened a device that was not
 * named native, or listed them): there the default is native, and other devices answer
 * ERROR_DEVICE.
 * The program sonject-decoder, if a call needed it, has no descriptors but its own, ends with the
 * context or this process, and is started anew where a file ended it. It is looked for in the
 * folder sonject beside the library (or beside the program that has it linked in), in the folder of
 * either, and where sonject was installed. */
SONJECT_API sonject_status sonject_context_create(const sonject_context_params *params,
                                                  sonject_context **context);

/* Releases the context and sets *context to NULL. NULL and a pointer to NULL are allowed.
 * Everything made with the context must be released before. */
SONJECT_API void sonject_context_release(sonject_context **context);

/* The message of the last failed call on this context, "" if none failed: one line; of a scene or
 * campaign file a line for each mistake, in the order of the file ("file:line:column: key: ..."),
 * at most 50, then "and N more"; the last line has no end. It names what is wrong and where. Valid
 * until the next call on the context. */
SONJECT_API const char *sonject_context_message(const sonject_context *context);

/* A device. */
typedef struct sonject_device_info {
    char name[128];
    char platform[128];
    char driver[128];
    uint32_t compute_units;
    uint32_t vector_width; /* lanes that the kernels are compiled for */
    uint32_t is_default;   /* 1 for the one that a context takes when not asked for another */
    uint32_t reserved;
} sonject_device_info;

/* Lists the devices: native, then OpenCL's. devices: room for capacity entries (NULL if capacity is
 * 0); *count gets the number found, which may exceed capacity. Where OpenCL's cannot be asked, the
 * log says why. Errors: ARGUMENT, MEMORY. */
SONJECT_API sonject_status sonject_devices(sonject_context *context, sonject_device_info *devices,
                                           size_t capacity, size_t *count);

SONJECT_END_DECLARATIONS

#endif
