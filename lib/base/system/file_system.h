/* The system's files and folders. A path is UTF-8 text whose parts are divided by '/', on Windows
 * by '\', too. Functions that return int give 0 or an errno. */
#ifndef SONJECT_BASE_SYSTEM_FILE_SYSTEM_H
#define SONJECT_BASE_SYSTEM_FILE_SYSTEM_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum path_kind {
    PATH_IS_FILE,
    PATH_IS_FOLDER,
    PATH_IS_DEVICE /* a device or pipe */
};

/* Facts about a path, links followed. Device and number tell a file from all others. */
struct path_facts {
    enum path_kind kind;
    uint64_t device, number;
    uint64_t bytes;
    int64_t changed_s, changed_ns; /* time of the last change */
};

int path_facts_read(const char *path, struct path_facts *facts);

bool file_exists(const char *path);

/* Discards all that is written to an open file's descriptor from now on. */
void descriptor_lead_nowhere(int descriptor);

/* Opens a file as fopen does, in binary mode. Programs that are started do not get the file. */
FILE *file_open(const char *path, const char *mode);

/* Opens a regular file for reading, and never waits. Returns NULL with errno on failure: EISDIR for
 * a folder, ESPIPE for pipes and devices, which may have no end. */
FILE *byte_file_open(const char *path, uint64_t *bytes);

/* Returns false with errno on failure. */
bool byte_file_seek(FILE *file, uint64_t place);

/* Returns where the next byte is read or written; UINT64_MAX with errno if unknown. */
uint64_t byte_file_place(FILE *file);

/* Renames a file to `to` once all bytes are on disk, in place of a file that is there. */
int file_replace(const char *from, const char *to);

/* Removes a file if it is there. Never fails, and keeps errno. */
void file_discard(const char *path);

/* Makes a folder, whose parent must exist. Returns 0 also if the folder exists. */
int folder_make_one(const char *path);

/* Removes a folder if it is empty. Never fails. */
void folder_discard(const char *path);

/* Gives the names in a folder to hear, in any order, until hear returns false. */
int folder_hear_names(const char *path, bool (*hear)(void *user, const char *name), void *user);

/* Returns the working folder, for free(); NULL with errno if it has no name. */
char *working_folder(void);

/* Returns whether a character divides a path into parts. */
bool is_divider(char character);

bool path_is_absolute(const char *path);

/* Returns whether a disk, near or far, could not be read or written. */
bool error_is_of_disk(int error);

/* Writes the system's words for an errno. */
void error_text(int error, char *text, size_t capacity);

#endif
