/* Files that appear whole or not at all, files read by offset, and folders. */
#ifndef SONJECT_BASE_FILE_H
#define SONJECT_BASE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/memory.h"
#include "base/report.h"
#include "base/system/file_system.h"

/* Reports "path: cannot <action>: <reason>" for an errno. Returns STORAGE, or MEMORY for ENOMEM. */
sonject_status file_failure(struct report *report, const char *path, const char *action, int error);

/* Reports "path: ..." for a fault in a file, or in what the user gave. Returns INPUT. */
sonject_status input_failure(struct report *report, const char *path, const char *format, ...)
    REPORT_FORMAT(3);

/* Returns whether the system failed, whatever the file: a disk's error, too many open files. */
bool file_error_is_of_system(int error);

/* Reports that a file cannot be opened to be read. Returns STORAGE or MEMORY if the system failed;
 * INPUT otherwise, as for a missing file. */
sonject_status file_refuse(struct report *report, const char *path, int error);

/* Corrects the status of a reader that began with errno 0 and found its file wrong. If the disk
 * could not be read, reports the system's message and returns STORAGE; else returns status. */
sonject_status file_check_disk(struct report *report, const char *path, sonject_status status);

/* Returns a private name beside path for an unfinished file:
 * "<path>.<place>-<process>-<unique>.part<extension of path>", so that writers that choose by
 * extension still work. For free(); NULL if out of memory. */
char *file_part_name(const char *path);

/* Removes the parts that ended processes left in a folder. Parts of other hosts and containers
 * stay: whether their processes live is unknown here. Never fails. */
void folder_tidy(const char *path);

/* Remembers a file that the call reads, which no result may replace. The last INPUTS_KEPT count. */
void file_protect(struct report *report, const char *path);

/* Refuses a path that leads to a protected file, or to a pipe or a device, which a rename would
 * replace. Errors: ARGUMENT. */
sonject_status file_check_replaced(struct report *report, const char *path);

/* Flushes the file part to disk and renames it to path. On failure removes part; the message names
 * path and the reason (errno text). Errors: STORAGE, MEMORY, ARGUMENT (a path as
 * file_check_replaced refuses). */
sonject_status file_publish(struct report *report, const char *part, const char *path);

/* Writes a head and bytes to path, whole or not at all. Errors: STORAGE, MEMORY. */
sonject_status file_write_parts(struct report *report, const char *path, const void *head,
                                size_t head_bytes, const void *bytes, size_t count);

sonject_status file_write_whole(struct report *report, const char *path, const void *bytes,
                                size_t count);

/* Writes a growing text to a file, whole or not at all, and releases the text. Errors: STORAGE,
 * MEMORY (also if it was out before). */
sonject_status growing_text_write(struct report *report, struct growing_text *text,
                                  const char *path);

/* Reads a whole file of at most limit bytes into *bytes, for free(), with a terminating 0 beyond
 * *count. Errors: STORAGE (cannot open, read), INPUT (beyond limit, a pipe or a device), MEMORY. */
sonject_status file_read_whole(struct report *report, const char *path, size_t limit, char **bytes,
                               size_t *count);

/* Makes the folder and its missing parents. Errors: STORAGE, MEMORY. */
sonject_status folder_make(struct report *report, const char *path);

/* Returns whether two paths, links followed, lead to one file or folder that exists. A path of ""
 * is the working folder. */
bool paths_are_same(const char *a, const char *b);

/* Returns false if the file does not hold count bytes at place. */
bool byte_file_read(FILE *file, uint64_t place, void *bytes, size_t count);

/* Copies count bytes at place to the current position of to. Returns false on failure. */
bool byte_file_copy(FILE *from, uint64_t place, uint64_t count, FILE *to);

/* Reads the facts of a regular file, links followed. Errors: STORAGE (no file, a folder), INPUT (a
 * pipe or a device). */
sonject_status file_identify(struct report *report, const char *path, struct path_facts *facts);

/* The names in a folder. */
struct folder_names {
    char **names; /* owned; sorted */
    size_t count;
};

/* Lists the names that begin with prefix; none if there is no folder. On success list is for
 * folder_names_clear; on failure nothing is held. Errors: STORAGE, MEMORY (also above 2^20
 * names). */
sonject_status folder_names_read(struct folder_names *list, struct report *report, const char *path,
                                 const char *prefix);
void folder_names_clear(struct folder_names *list);

/* Returns folder + "/" + name, for free(). An absolute name is copied as it is; folder "" gives
 * name. NULL if out of memory. */
char *path_join(const char *folder, const char *name);

/* Files as they were when they were read. Starts as zeros; ends with read_files_clear. */
struct read_files {
    struct read_file {
        char *path;
        struct path_facts facts;
    } * files; /* each path once */
    size_t count;
};

/* Notes a file that is about to be read, if report->reads wants it. Errors: MEMORY. */
sonject_status file_note_read(struct report *report, const char *path);
void read_files_clear(struct read_files *reads);

/* Returns whether the file still has the size and the time of change. */
bool file_is_unchanged(const char *path, const struct path_facts *facts);

#define PATH_CAPACITY 4096 /* the system opens no longer path */

/* Writes the path of a formatted name as path_join does. Errors: STORAGE (too long). */
sonject_status path_in(struct report *report, char path[PATH_CAPACITY], const char *folder,
                       const char *format, ...) REPORT_FORMAT(4);

/* Returns path, below the working folder if relative, for free(); NULL if out of memory. */
char *path_absolute(const char *path);

/* Returns the folder part of path ("" if none), for free(); NULL if out of memory. */
char *path_folder(const char *path);

/* Returns the part of path after the folder, within path. */
const char *path_name(const char *path);

#endif
