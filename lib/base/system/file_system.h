/* What is asked of the system's files and folders. A path is a UTF-8 text whose parts '/' divides;
 * on Windows '\' does, too. Functions that return int give 0 or an errno. */
#ifndef SONJECT_BASE_SYSTEM_FILE_SYSTEM_H
#define SONJECT_BASE_SYSTEM_FILE_SYSTEM_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum path_kind {
    PATH_IS_FILE,
    PATH_IS_FOLDER,
    PATH_IS_DEVICE /* or a pipe */
};

/* What a path leads to, links followed. Device and number tell it from all others. */
struct path_facts {
    enum path_kind kind;
    uint64_t device, number;
    uint64_t bytes;
    int64_t changed_s, changed_ns; /* when it last changed */
};

int path_facts_read(const char *path, struct path_facts *facts);

bool file_exists(const char *path);

/* From now on what is written to an open file's descriptor is lost. */
void descriptor_lead_nowhere(int descriptor);

/* As fopen, in binary mode; programs that this process starts do not get the file. */
FILE *file_open(const char *path, const char *mode);

/* Opens a regular file for reading, and never waits. NULL with errno if that fails: EISDIR for a
 * folder, ESPIPE for pipes and devices, which may have no end. */
FILE *byte_file_open(const char *path, uint64_t *bytes);

/* False with errno if that fails. */
bool byte_file_seek(FILE *file, uint64_t place);

/* Where it is read or written next; UINT64_MAX with errno if that is not known. */
uint64_t byte_file_place(FILE *file);

/* Takes the place of the file `to`, if there is one, once all bytes are on disk. */
int file_replace(const char *from, const char *to);

/* Removes a file if it is there; never fails, and keeps errno. */
void file_discard(const char *path);

/* 0, too, where the folder is there already. Its parent must be. */
int folder_make_one(const char *path);

/* Removes a folder if it is empty; never fails. */
void folder_discard(const char *path);

/* Gives the names in a folder to hear, in any order, until this returns false. */
int folder_hear_names(const char *path, bool (*hear)(void *user, const char *name), void *user);

/* The working folder, to be given to free(); NULL with errno where it has no name. */
char *working_folder(void);

/* Whether it divides a path into parts. */
bool is_divider(char character);

bool path_is_absolute(const char *path);

/* Whether a disk, near or far, could not be read or written. */
bool error_is_of_disk(int error);

/* The system's words for an errno. */
void error_text(int error, char *text, size_t capacity);

#endif
