/* Files that appear whole or not at all. */
#ifndef SONJECT_BASE_FILE_H
#define SONJECT_BASE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The message "path: cannot <action>: <reason>" for an errno. Returns STORAGE, or MEMORY for
 * ENOMEM. */
sonject_status file_failure(struct report *report, const char *path, const char *action, int error);

/* True for what the system fails in, of whatever file: a disk's error, too many open files. */
bool file_error_is_of_system(int error);

/* The message for a file that cannot be opened for reading. Returns STORAGE or MEMORY where the
 * system fails, else INPUT. */
sonject_status file_refuse(struct report *report, const char *path, int error);

/* For a reader that found its file wrong, with errno 0 when it began: where the disk could not be
 * read, the message is the system's, and STORAGE is returned; else status. */
sonject_status file_check_disk(struct report *report, const char *path, sonject_status status);

/* Opens a regular file for reading, and never waits. -1 with errno if that fails: EISDIR for a
 * folder, ESPIPE for pipes and devices, which may have no end. */
int file_open(const char *path);

/* A private name beside path for a file in the making:
 * "<path>.<place>-<process>-<unique>.part<extension of path>", so that writers that choose by
 * extension still work. To be given to free(); NULL when memory is out. */
char *file_part_name(const char *path);

/* Removes the parts in a folder that dead processes left. Those of other hosts and containers stay:
 * whether their processes live cannot be known here. Never fails. */
void folder_tidy(const char *path);

/* Flushes the file part to disk and renames it to path. On failure part is removed and the message
 * names path and the reason (errno text). Errors: STORAGE, MEMORY. */
sonject_status file_publish(struct report *report, const char *part, const char *path);

/* Removes a part if it is there; never fails. */
void file_discard(const char *part);

/* Writes bytes to path: a part, then published. Errors: STORAGE, MEMORY. */
sonject_status file_write_whole(struct report *report, const char *path, const void *bytes,
                                size_t count);

/* Reads a whole file of at most limit bytes into *bytes (one terminating 0 byte beyond *count), to
 * be given to free(). Errors: STORAGE (cannot open, read), INPUT (larger than limit, a pipe or a
 * device), MEMORY. */
sonject_status file_read_whole(struct report *report, const char *path, size_t limit, char **bytes,
                               size_t *count);

/* Makes the folder and its parents where missing. Errors: STORAGE. */
sonject_status folder_make(struct report *report, const char *path);

bool file_exists(const char *path);

/* What tells a file from others and from what it was before it was written anew. */
struct file_identity {
    uint64_t device, number; /* of the file on it */
    uint64_t bytes;
    int64_t changed_s, changed_ns; /* when it last changed */
};

/* Of a regular file, links followed. Errors: STORAGE (there is none, a folder), INPUT (a pipe or a
 * device). */
sonject_status file_identify(struct report *report, const char *path,
                             struct file_identity *identity);

/* folder + "/" + name, to be given to free(); an absolute name is copied as it is; folder "" gives
 * name. NULL when memory is out. */
char *path_join(const char *folder, const char *name);

/* The working folder, to be given to free(); NULL with errno where it has no name. */
char *working_folder(void);

/* path, or the working folder and path, to be given to free(); NULL when memory is out. */
char *path_absolute(const char *path);

/* The folder part of path ("" if none), to be given to free(). */
char *path_folder(const char *path);

#ifdef __cplusplus
}
#endif

#endif
