#define _POSIX_C_SOURCE 200809L
#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/memory.h"

/* Tries before giving up on a free name; names hold the process and the time, so one is enough
 * unless something is badly wrong. */
#define NAME_TRIES 100

static sonject_status storage_failure(struct report *report, const char *what, const char *path,
                                      int error)
{
    return report_failure(report, SONJECT_ERROR_STORAGE, "%s: cannot %s: %s", path, what,
                          strerror(error));
}

char *file_part_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *dot = strrchr(path, '.');
    const char *extension = dot && (!slash || dot > slash + 1) ? dot : "";
    const size_t capacity = strlen(path) + strlen(extension) + 64;
    char *part = allocate_array(capacity, 1);
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    for (int attempt = 0; part && attempt < NAME_TRIES; attempt++) {
        snprintf(part, capacity, "%s.%lx-%lx-%x.part%s", path, (unsigned long)getpid(),
                 (unsigned long)now.tv_sec * 1000000007ul ^ (unsigned long)now.tv_nsec,
                 (unsigned)attempt, extension);
        if (!file_exists(part))
            return part;
    }
    free(part);
    return NULL;
}

/* A rename survives a power cut only when the folder is on disk too. */
static void flush_folder(const char *path)
{
    char *folder = path_folder(path);
    if (!folder)
        return;
    const int handle = open(folder[0] ? folder : ".", O_RDONLY);
    if (handle >= 0) {
        (void)fsync(handle);
        close(handle);
    }
    free(folder);
}

static int flush_file(const char *path)
{
    const int handle = open(path, O_RDONLY);
    if (handle < 0)
        return errno;
    const int error = fsync(handle) == 0 ? 0 : errno;
    close(handle);
    return error == EINVAL ? 0 : error; /* pipes and the like cannot be flushed */
}

sonject_status file_publish(struct report *report, const char *part, const char *path)
{
    int error = flush_file(part);
    if (error == 0 && rename(part, path) != 0)
        error = errno;
    if (error != 0) {
        file_discard(part);
        return storage_failure(report, "write", path, error);
    }
    flush_folder(path);
    return SONJECT_OK;
}

void file_discard(const char *part)
{
    if (part)
        (void)unlink(part);
}

sonject_status file_write_whole(struct report *report, const char *path, const void *bytes,
                                size_t count)
{
    char *part = file_part_name(path);
    if (!part)
        return report_out_of_memory(report, "a file name");
    sonject_status status = SONJECT_OK;
    FILE *file = fopen(part, "wbx");
    if (!file) {
        status = storage_failure(report, "write", path, errno);
    } else {
        const int failed = fwrite(bytes, 1, count, file) != count;
        int error = failed ? errno : 0;
        if (fclose(file) != 0 && error == 0)
            error = errno;
        if (failed || error != 0) {
            file_discard(part);
            status = storage_failure(report, "write", path, error);
        } else {
            status = file_publish(report, part, path);
        }
    }
    free(part);
    return status;
}

/* Reads to the end, growing; a size asked of the system beforehand could be wrong by then. */
static sonject_status read_growing(struct report *report, const char *path, FILE *file,
                                   size_t limit, char **bytes, size_t *count)
{
    size_t capacity = 65536;
    *count = 0;
    *bytes = malloc(capacity + 1);
    while (*bytes) {
        *count += fread(*bytes + *count, 1, capacity - *count, file);
        if (ferror(file))
            return storage_failure(report, "read", path, errno);
        if (*count > limit)
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "%s: is larger than the %zu bytes allowed", path, limit);
        if (*count < capacity) {
            (*bytes)[*count] = '\0';
            return SONJECT_OK;
        }
        capacity *= 2;
        char *grown = realloc(*bytes, capacity + 1);
        if (!grown)
            break;
        *bytes = grown;
    }
    return report_out_of_memory(report, path);
}

sonject_status file_read_whole(struct report *report, const char *path, size_t limit, char **bytes,
                               size_t *count)
{
    *bytes = NULL;
    *count = 0;
    FILE *file = fopen(path, "rb");
    if (!file)
        return storage_failure(report, "read", path, errno);
    const sonject_status status = read_growing(report, path, file, limit, bytes, count);
    fclose(file);
    if (status != SONJECT_OK) {
        free(*bytes);
        *bytes = NULL;
        *count = 0;
    }
    return status;
}

static int make_one(const char *path)
{
    struct stat facts;
    if (mkdir(path, 0777) == 0)
        return 0;
    const int error = errno;
    return error == EEXIST && stat(path, &facts) == 0 && S_ISDIR(facts.st_mode) ? 0 : error;
}

sonject_status folder_make(struct report *report, const char *path)
{
    char *parent = copy_text(path);
    if (!parent)
        return report_out_of_memory(report, "a path");
    int error = 0;
    for (char *at = parent + 1; *parent && *at && error == 0; at++) {
        if (*at != '/')
            continue;
        *at = '\0';
        error = make_one(parent);
        *at = '/';
    }
    free(parent);
    if (error == 0)
        error = make_one(path);
    return error == 0 ? SONJECT_OK : storage_failure(report, "make the folder", path, error);
}

bool file_exists(const char *path)
{
    struct stat facts;
    return stat(path, &facts) == 0;
}

char *path_join(const char *folder, const char *name)
{
    if (name[0] == '/' || folder[0] == '\0')
        return copy_text(name);
    const size_t capacity = strlen(folder) + strlen(name) + 2;
    char *path = malloc(capacity);
    const char *between = folder[strlen(folder) - 1] == '/' ? "" : "/";
    if (path)
        snprintf(path, capacity, "%s%s%s", folder, between, name);
    return path;
}

char *path_folder(const char *path)
{
    const char *slash = strrchr(path, '/');
    const size_t length = slash == path ? 1 : slash ? (size_t)(slash - path) : 0;
    char *folder = allocate_array(length + 1, 1);
    if (folder)
        memcpy(folder, path, length);
    return folder;
}
