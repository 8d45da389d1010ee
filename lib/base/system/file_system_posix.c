#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64
#include "base/system/file_system.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define PATH_BYTES_MAX ((size_t)1 << 16)

int path_facts_read(const char *path, struct path_facts *facts)
{
    struct stat found;
    memset(facts, 0, sizeof *facts);
    if (stat(path, &found) != 0)
        return errno;
    facts->kind = S_ISREG(found.st_mode)   ? PATH_IS_FILE
                  : S_ISDIR(found.st_mode) ? PATH_IS_FOLDER
                                           : PATH_IS_DEVICE;
    facts->device = (uint64_t)found.st_dev;
    facts->number = (uint64_t)found.st_ino;
    facts->bytes = (uint64_t)found.st_size;
    facts->changed_s = (int64_t)found.st_mtim.tv_sec;
    facts->changed_ns = (int64_t)found.st_mtim.tv_nsec;
    return 0;
}

bool file_exists(const char *path)
{
    struct stat found;
    return stat(path, &found) == 0;
}

FILE *file_open(const char *path, const char *mode)
{
    char closing[8]; /* 'e': not for started programs; other C libraries ignore it */
    snprintf(closing, sizeof closing, "%se", mode);
    return fopen(path, closing);
}

void descriptor_lead_nowhere(int descriptor)
{
    const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
    if (nowhere < 0)
        return;
    dup2(nowhere, descriptor);
    close(nowhere);
}

FILE *byte_file_open(const char *path, uint64_t *bytes)
{
    struct stat facts;
    FILE *file = NULL;
    int descriptor = -1;
    /* looks first, because some devices do something when they are opened */
    if (stat(path, &facts) != 0)
        return NULL;
    if (S_ISREG(facts.st_mode)) {
        descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
        if (descriptor < 0)
            return NULL;
    }
    if (descriptor < 0 || fstat(descriptor, &facts) == 0) {
        errno = S_ISDIR(facts.st_mode) ? EISDIR : ESPIPE;
        file = S_ISREG(facts.st_mode) ? fdopen(descriptor, "rb") : NULL;
    }
    *bytes = (uint64_t)facts.st_size;
    const int error = errno;
    if (!file && descriptor >= 0)
        close(descriptor);
    errno = error;
    return file;
}

bool byte_file_seek(FILE *file, uint64_t place)
{
    return place <= INT64_MAX && fseeko(file, (off_t)place, SEEK_SET) == 0;
}

uint64_t byte_file_place(FILE *file)
{
    return (uint64_t)ftello(file);
}

static int flush_to_disk(const char *path)
{
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0)
        return errno;
    int error = fsync(descriptor) == 0 ? 0 : errno;
    if (close(descriptor) != 0 && error == 0)
        error = errno;
    return error;
}

/* Flushes a folder, without which a rename is not safe from a power cut. File systems that cannot
 * flush a folder say EINVAL, and a folder that may be written but not read says EACCES. Neither
 * harms the files. */
static int flush_folder_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *folder = malloc(strlen(path) + 2);
    if (!folder)
        return ENOMEM;
    strcpy(folder, slash ? path : ".");
    if (slash)
        folder[slash == path ? 1 : slash - path] = '\0';
    const int error = flush_to_disk(folder);
    free(folder);
    return error == EINVAL || error == EACCES ? 0 : error;
}

int file_replace(const char *from, const char *to)
{
    const int error = flush_to_disk(from);
    if (error != 0)
        return error;
    return rename(from, to) == 0 ? flush_folder_of(to) : errno;
}

void file_discard(const char *path)
{
    const int kept = errno;
    unlink(path);
    errno = kept;
}

int folder_make_one(const char *path)
{
    struct stat facts;
    if (mkdir(path, 0777) == 0)
        return 0;
    const int error = errno;
    if (stat(path, &facts) == 0)
        return S_ISDIR(facts.st_mode) ? 0 : ENOTDIR;
    return error;
}

void folder_discard(const char *path)
{
    rmdir(path);
}

int folder_hear_names(const char *path, bool (*hear)(void *user, const char *name), void *user)
{
    DIR *folder = opendir(path);
    if (!folder)
        return errno;
    const struct dirent *entry;
    bool goes_on = true;
    while (goes_on && (errno = 0, entry = readdir(folder)) != NULL)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            goes_on = hear(user, entry->d_name);
    const int error = goes_on ? errno : 0;
    closedir(folder);
    return error;
}

char *working_folder(void)
{
    for (size_t bytes = 256; bytes <= PATH_BYTES_MAX; bytes *= 2) {
        char *folder = malloc(bytes);
        if (!folder || getcwd(folder, bytes))
            return folder;
        free(folder);
        if (errno != ERANGE)
            return NULL;
    }
    return NULL;
}

bool is_divider(char character)
{
    return character == '/';
}

bool path_is_absolute(const char *path)
{
    return path[0] == '/';
}

bool error_is_of_disk(int error)
{
    return error == EIO || error == ESTALE || error == ETIMEDOUT;
}

void error_text(int error, char *text, size_t capacity)
{
    if (strerror_r(error, text, capacity) != 0)
        snprintf(text, capacity, "error %d", error);
}
