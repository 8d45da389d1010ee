/* Files that appear whole or not at all, files read by place, and folders. */
#ifndef SONJECT_BASE_FILE_H
#define SONJECT_BASE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/memory.h"
#include "base/report.h"
#include "base/system/file_system.h"

/* The message "path: cannot <action>: <reason>" for an errno. Returns STORAGE, or MEMORY for
 * ENOMEM. */
sonject_status file_failure(struct report *report, const char *path, const char *action, int error);

/* The message "path: ..." for what a file holds, or another mistake of whoever gave it. Returns
 * INPUT.
 */
sonject_status input_failure(struct report *report, const char *path, const char *format, ...)
    REPORT_FORMAT(3);

/* True for what the system fails in, of whatever file: a disk's error, too many open files. */
bool file_error_is_of_system(int error);

/* The message for a file that cannot be opened for reading. Returns STORAGE or MEMORY where the
 * system fails, else INPUT. */
sonject_status file_refuse(struct report *report, const char *path, int error);

/* For a reader that found its file wrong, with errno 0 when it began: where the disk could not be
 * read, the message is the system's, and STORAGE is returned; else status. */
sonject_status file_check_disk(struct report *report, const char *path, sonject_status status);

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

/* Writes a head and bytes to path: a part, then published. Errors: STORAGE, MEMORY. */
sonject_status file_write_parts(struct report *report, const char *path, const void *head,
                                size_t head_bytes, const void *bytes, size_t count);

sonject_status file_write_whole(struct report *report, const char *path, const void *bytes,
                                size_t count);

/* Writes a growing text to a file, whole or not at all, and releases it. Errors: STORAGE, MEMORY
 * (also where it was out before). */
sonject_status growing_text_write(struct report *report, struct growing_text *text,
                                  const char *path);

/* Reads a whole file of at most limit bytes into *bytes (one terminating 0 byte beyond *count), to
 * be given to free(). Errors: STORAGE (cannot open, read), INPUT (larger than limit, a pipe or a
 * device), MEMORY. */
sonject_status file_read_whole(struct report *report, const char *path, size_t limit, char **bytes,
                               size_t *count);

/* Makes the folder and its parents where missing. Errors: STORAGE. */
sonject_status folder_make(struct report *report, const char *path);

/* Whether two paths, links followed, are of one file or folder that is there; "" is the working
 * folder. */
bool paths_are_same(const char *a, const char *b);

/* False if the file does not hold as much. */
bool byte_file_read(FILE *file, uint64_t place, void *bytes, size_t count);

/* Copies count bytes of from to where to stands; false if reading or writing fails. */
bool byte_file_copy(FILE *from, uint64_t place, uint64_t count, FILE *to);

/* Of a regular file, links followed. Errors: STORAGE (there is none, a folder), INPUT (a pipe or a
 * device). */
sonject_status file_identify(struct report *report, const char *path, struct path_facts *facts);

/* The names in a folder. */
struct folder_names {
    char **names; /* owned; sorted */
    size_t count;
};

/* Lists what begins with prefix; nothing where there is no such folder. On
 * success to be given to folder_names_clear; on failure nothing is held. Errors: STORAGE, MEMORY
 * (of more than a million names, too). */
sonject_status folder_names_read(struct folder_names *list, struct report *report, const char *path,
                                 const char *prefix);
void folder_names_clear(struct folder_names *list);

/* folder + "/" + name, to be given to free(); an absolute name is copied as it is; folder "" gives
 * name. NULL when memory is out. */
char *path_join(const char *folder, const char *name);

#define PATH_CAPACITY 4096 /* the system opens no longer one */

/* Writes the same of a name that is formatted. Errors: STORAGE (it is too long). */
sonject_status path_in(struct report *report, char path[PATH_CAPACITY], const char *folder,
                       const char *format, ...) REPORT_FORMAT(4);

/* path, or the working folder and path, to be given to free(); NULL when memory is out. */
char *path_absolute(const char *path);

/* The folder part of path ("" if none), to be given to free(). */
char *path_folder(const char *path);

/* What follows the folder part, within path. */
const char *path_name(const char *path);

#endif
