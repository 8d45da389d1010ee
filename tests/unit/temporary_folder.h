/* A fresh folder for files that tests write. Include this header after cmocka.h. */
#ifndef TEMPORARY_FOLDER_H
#define TEMPORARY_FOLDER_H

#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define TEMPORARY_CAPACITY 1024

struct temporary_folder {
    char path[TEMPORARY_CAPACITY];
    char file[TEMPORARY_CAPACITY + 300]; /* path that temporary_file() made last */
};

/* Makes a folder, and returns whether it was made. */
static inline bool open_temporary_folder(struct temporary_folder *folder)
{
    const char *temporary = getenv("TMPDIR");
    snprintf(folder->path, sizeof folder->path, "%s/sonject-test-XXXXXX",
             temporary ? temporary : "/tmp");
#ifdef HAS_POSIX
    return mkdtemp(folder->path) != NULL;
#else
    return mkdir(mktemp(folder->path)) == 0;
#endif
}

static inline bool is_entry(const struct dirent *entry)
{
    return strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
}

static inline int count_entries(const char *path)
{
    int count = 0;
    DIR *folder = opendir(path);
    if (!folder)
        return -1;
    for (const struct dirent *entry = readdir(folder); entry; entry = readdir(folder))
        count += is_entry(entry);
    closedir(folder);
    return count;
}

/* Removes a folder with all that is in it. Returns 0, or nonzero if it is not there. */
static inline int remove_folder(const char *folder)
{
    char path[TEMPORARY_CAPACITY + 300];
    DIR *list = opendir(folder);
    if (!list)
        return 1;
    for (const struct dirent *entry = readdir(list); entry; entry = readdir(list))
        if (is_entry(entry) &&
            snprintf(path, sizeof path, "%s/%s", folder, entry->d_name) < (int)sizeof path &&
            unlink(path) != 0)
            (void)remove_folder(path);
    closedir(list);
    return rmdir(folder);
}

static inline int close_temporary_folder(const struct temporary_folder *folder)
{
    return remove_folder(folder->path);
}

/* Set up and tear down a cmocka test. *state is the struct temporary_folder. */
static inline int make_temporary_folder(void **state)
{
    struct temporary_folder *folder = calloc(1, sizeof *folder);
    *state = folder;
    return !folder || !open_temporary_folder(folder);
}

static inline int remove_temporary_folder(void **state)
{
    const int result = close_temporary_folder(*state);
    free(*state);
    return result;
}

#define IN_FOLDER(name) TEST_WITH(name, make_temporary_folder, remove_temporary_folder)

/* Returns folder/name, valid until the next call. */
static inline const char *temporary_file(struct temporary_folder *folder, const char *name)
{
    snprintf(folder->file, sizeof folder->file, "%s/%s", folder->path, name);
    return folder->file;
}

/* Closes a file, and returns all its bytes with a 0 behind them. The caller frees the copy. */
static inline unsigned char *bytes_of_stream(FILE *file, size_t *count)
{
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *count = (size_t)ftell(file);
    rewind(file);
    unsigned char *bytes = zeroed(*count + 1, 1);
    assert_int_equal(fread(bytes, 1, *count, file), *count);
    fclose(file);
    return bytes;
}

static inline unsigned char *bytes_of_file(const char *path, size_t *count)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        fail_msg("%s is not there", path);
    return bytes_of_stream(file, count);
}

/* Opens a new file to be written, in place of one that may be there. On some file systems a file
 * that is cut to nothing goes to the disk at once, which takes a hundred times as long. */
static inline FILE *open_new_file(const char *path)
{
    (void)remove(path);
    return fopen(path, "wb");
}

static inline void write_bytes(const char *path, const void *bytes, size_t count)
{
    FILE *file = open_new_file(path);
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, count, file), count);
    assert_int_equal(fclose(file), 0);
}

#endif
