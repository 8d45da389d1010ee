#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64
#include "base/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <time.h>
#include <unistd.h>

#define PATH_BYTES_MAX ((size_t)1 << 16)
#define NAMES_MAX      ((size_t)1 << 20) /* in a folder */

sonject_status input_failure(struct report *report, const char *path, const char *format, ...)
{
    char what[REPORT_LINE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    return report_failure(report, SONJECT_ERROR_INPUT, "%s: %s", path, what);
}

sonject_status file_failure(struct report *report, const char *path, const char *action, int error)
{
    char reason[128];
    if (strerror_r(error, reason, sizeof reason) != 0)
        snprintf(reason, sizeof reason, "error %d", error);
    return report_failure(report, error == ENOMEM ? SONJECT_ERROR_MEMORY : SONJECT_ERROR_STORAGE,
                          "%s: cannot %s: %s", path, action, reason);
}

bool file_error_is_of_system(int error)
{
    return error == EIO || error == ENXIO || error == ENODEV || error == ESTALE ||
           error == ETIMEDOUT || error == EMFILE || error == ENFILE || error == ENOMEM;
}

static sonject_status refuse_endless(struct report *report, const char *path)
{
    return input_failure(report, path,
                         "is not a regular file but a pipe or a device: copy it to a file");
}

sonject_status file_refuse(struct report *report, const char *path, int error)
{
    if (error == ESPIPE)
        return refuse_endless(report, path);
    const sonject_status status = file_failure(report, path, "open", error);
    return file_error_is_of_system(error) ? status : SONJECT_ERROR_INPUT;
}

sonject_status file_check_disk(struct report *report, const char *path, sonject_status status)
{
    const bool is_of_disk = errno == EIO || errno == ESTALE || errno == ETIMEDOUT;
    return status == SONJECT_ERROR_INPUT && is_of_disk ? file_failure(report, path, "read", errno)
                                                       : status;
}

/* From a '.' inside the last component to the end; "" if there is none. */
static const char *extension_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *name = slash ? slash + 1 : path;
    const char *dot = strrchr(name, '.');
    return dot && dot != name ? dot : "";
}

/* Random where the system gives random bytes. Process number, clocks and stack address keep
 * processes and threads apart where it does not. */
static uint64_t unique_number(void)
{
    uint64_t number = 0;
    struct timespec now = {0, 0};
    const int source = open("/dev/urandom", O_RDONLY | O_CLOEXEC);
    if (source >= 0) {
        if (read(source, &number, sizeof number) != (ssize_t)sizeof number)
            number = 0;
        close(source);
    }
    clock_gettime(CLOCK_MONOTONIC, &now);
    number ^= (uint64_t)now.tv_nsec * UINT64_C(0x9E3779B97F4A7C15);
    return number ^ (uint64_t)(uintptr_t)&now;
}

/* Names where this process's number means something: the host, and on Linux the space of process
 * numbers that a container has for itself. */
static uint32_t process_place(void)
{
    char name[512] = "";
    gethostname(name, 256);
    name[255] = '\0';
    const size_t length = strlen(name);
    const ssize_t got = readlink("/proc/self/ns/pid", name + length, sizeof name - length);
    uint32_t place = UINT32_C(2166136261); /* FNV-1a */
    for (size_t i = 0; i < length + (got > 0 ? (size_t)got : 0); i++)
        place = (place ^ (unsigned char)name[i]) * UINT32_C(16777619);
    return place;
}

char *file_part_name(const char *path)
{
    const char *extension = extension_of(path);
    const size_t capacity = strlen(path) + strlen(extension) + 64;
    char *part = allocate_array(capacity, 1);
    if (part)
        snprintf(part, capacity, "%s.%08" PRIx32 "-%ld-%016" PRIx64 ".part%s", path,
                 process_place(), (long)getpid(), unique_number(), extension);
    return part;
}

/* Whether that is a part's name, of a process of this place that is no more. */
static bool is_orphan(const char *name)
{
    for (const char *dot = strchr(name, '.'); dot; dot = strchr(dot + 1, '.')) {
        uint32_t place;
        long process;
        uint64_t unique;
        int end = 0;
        if (sscanf(dot, ".%8" SCNx32 "-%ld-%16" SCNx64 ".part%n", &place, &process, &unique,
                   &end) == 3 &&
            end > 0 && (dot[end] == '.' || dot[end] == '\0'))
            return place == process_place() && process > 0 && kill((pid_t)process, 0) != 0 &&
                   errno == ESRCH;
    }
    return false;
}

void folder_tidy(const char *path)
{
    DIR *folder = opendir(path);
    if (!folder)
        return;
    for (const struct dirent *entry = readdir(folder); entry; entry = readdir(folder)) {
        char *name = is_orphan(entry->d_name) ? path_join(path, entry->d_name) : NULL;
        if (name)
            file_discard(name);
        free(name);
    }
    closedir(folder);
}

/* 0, or the errno of what failed. */
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

/* A rename is only safe from a power cut once the folder is on disk. File systems that cannot flush
 * a folder say EINVAL; a folder that may be written but not read says EACCES: neither harms what
 * was written. */
static int flush_folder_of(const char *path)
{
    char *folder = path_folder(path);
    if (!folder)
        return ENOMEM;
    const int error = flush_to_disk(*folder ? folder : ".");
    free(folder);
    return error == EINVAL || error == EACCES ? 0 : error;
}

sonject_status file_publish(struct report *report, const char *part, const char *path)
{
    int error = flush_to_disk(part);
    if (error == 0 && rename(part, path) != 0)
        error = errno;
    if (error != 0) {
        file_discard(part);
        return file_failure(report, path, "write", error);
    }
    error = flush_folder_of(path);
    return error == 0 ? SONJECT_OK : file_failure(report, path, "write", error);
}

void file_discard(const char *part)
{
    const int kept = errno;
    unlink(part);
    errno = kept;
}

sonject_status file_write_parts(struct report *report, const char *path, const void *head,
                                size_t head_bytes, const void *bytes, size_t count)
{
    char *part = file_part_name(path);
    CHECK_MEMORY(report, part, "a file name");
    errno = 0;
    FILE *file = fopen(part, "wb");
    bool is_written = file && fwrite(head, 1, head_bytes, file) == head_bytes &&
                      fwrite(bytes, 1, count, file) == count;
    int error = errno;
    if (file && fclose(file) != 0 && is_written) {
        is_written = false;
        error = errno;
    }
    if (!is_written)
        file_discard(part);
    const sonject_status status = is_written
                                      ? file_publish(report, part, path)
                                      : file_failure(report, path, "write", error ? error : EIO);
    free(part);
    return status;
}

sonject_status file_write_whole(struct report *report, const char *path, const void *bytes,
                                size_t count)
{
    return file_write_parts(report, path, "", 0, bytes, count);
}

sonject_status file_read_whole(struct report *report, const char *path, size_t limit, char **bytes,
                               size_t *count)
{
    uint64_t size = 0;
    *bytes = NULL;
    *count = 0;
    FILE *file = byte_file_open(path, &size);
    if (!file)
        return errno == ESPIPE
                   ? refuse_endless(report, path)
                   : file_failure(report, path, errno == EISDIR ? "read" : "open", errno);
    sonject_status status = SONJECT_OK;
    if (size > limit)
        status = input_failure(report, path, "larger than %zu bytes", limit);
    else if (!(*bytes = allocate_array((size_t)size + 1, 1)))
        status = report_out_of_memory(report, path);
    else if ((*count = fread(*bytes, 1, (size_t)size, file)) < size && ferror(file))
        status = file_failure(report, path, "read", errno);
    fclose(file);
    if (status != SONJECT_OK) {
        free(*bytes);
        *bytes = NULL;
        *count = 0;
    }
    return status;
}

sonject_status growing_text_write(struct report *report, struct growing_text *text,
                                  const char *path)
{
    char *whole = growing_text_end(text);
    CHECK_MEMORY(report, whole, path);
    const sonject_status status = file_write_whole(report, path, whole, strlen(whole));
    free(whole);
    return status;
}

FILE *byte_file_open(const char *path, uint64_t *bytes)
{
    struct stat facts;
    FILE *file = NULL;
    int descriptor = -1;
    /* looked at first, for some devices do something when they are opened */
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

bool byte_file_read(FILE *file, uint64_t place, void *bytes, size_t count)
{
    return place <= INT64_MAX && fseeko(file, (off_t)place, SEEK_SET) == 0 &&
           fread(bytes, 1, count, file) == count;
}

bool byte_file_copy(FILE *from, uint64_t place, uint64_t count, FILE *to)
{
    unsigned char buffer[16384];
    if (place > INT64_MAX || fseeko(from, (off_t)place, SEEK_SET) != 0)
        return false;
    while (count > 0) {
        const size_t some = count < sizeof buffer ? (size_t)count : sizeof buffer;
        if (fread(buffer, 1, some, from) != some || fwrite(buffer, 1, some, to) != some)
            return false;
        count -= some;
    }
    return true;
}

static int make_one_folder(const char *path)
{
    struct stat facts;
    if (mkdir(path, 0777) == 0)
        return 0;
    const int error = errno;
    if (stat(path, &facts) == 0)
        return S_ISDIR(facts.st_mode) ? 0 : ENOTDIR;
    return error;
}

sonject_status folder_make(struct report *report, const char *path)
{
    char *name = copy_text(path);
    CHECK_MEMORY(report, name, "a folder's name");
    int error = 0;
    for (char *end = name; error == 0 && *end; end++) {
        if (*end != '/' || end == name)
            continue;
        *end = '\0';
        error = make_one_folder(name);
        *end = '/';
    }
    if (error == 0)
        error = make_one_folder(name);
    free(name);
    return error == 0 ? SONJECT_OK : file_failure(report, path, "make the folder", error);
}

sonject_status file_identify(struct report *report, const char *path,
                             struct file_identity *identity)
{
    struct stat facts;
    memset(identity, 0, sizeof *identity);
    if (stat(path, &facts) != 0)
        return file_failure(report, path, "open", errno);
    if (S_ISDIR(facts.st_mode))
        return file_failure(report, path, "read", EISDIR);
    if (!S_ISREG(facts.st_mode))
        return refuse_endless(report, path);
    identity->device = (uint64_t)facts.st_dev;
    identity->number = (uint64_t)facts.st_ino;
    identity->bytes = (uint64_t)facts.st_size;
    identity->changed_s = (int64_t)facts.st_mtim.tv_sec;
    identity->changed_ns = (int64_t)facts.st_mtim.tv_nsec;
    return SONJECT_OK;
}

bool file_exists(const char *path)
{
    struct stat facts;
    return stat(path, &facts) == 0;
}

bool paths_are_same(const char *a, const char *b)
{
    struct stat one, other;
    return stat(*a ? a : ".", &one) == 0 && stat(*b ? b : ".", &other) == 0 &&
           one.st_dev == other.st_dev && one.st_ino == other.st_ino;
}

char *path_join(const char *folder, const char *name)
{
    const size_t folder_length = strlen(folder);
    if (name[0] == '/' || folder_length == 0)
        return copy_text(name);
    const size_t capacity = folder_length + strlen(name) + 2;
    char *path = allocate_array(capacity, 1);
    if (path)
        snprintf(path, capacity, "%s%s%s", folder, folder[folder_length - 1] == '/' ? "" : "/",
                 name);
    return path;
}

sonject_status path_in(struct report *report, char path[PATH_CAPACITY], const char *folder,
                       const char *format, ...)
{
    char name[PATH_CAPACITY];
    va_list values;
    va_start(values, format);
    const int length = vsnprintf(name, sizeof name, format, values);
    va_end(values);
    const size_t own = strlen(folder);
    const bool is_alone = own == 0 || name[0] == '/';
    const char *slash = is_alone || folder[own - 1] == '/' ? "" : "/";
    const int whole = snprintf(path, PATH_CAPACITY, "%s%s%s", is_alone ? "" : folder, slash, name);
    if (length < 0 || length >= PATH_CAPACITY || whole < 0 || whole >= PATH_CAPACITY)
        return file_failure(report, folder, "name a file below", ENAMETOOLONG);
    return SONJECT_OK;
}

char *working_folder(void)
{
    for (size_t bytes = 256; bytes <= PATH_BYTES_MAX; bytes *= 2) {
        char *folder = allocate_array(bytes, 1);
        if (!folder || getcwd(folder, bytes))
            return folder;
        free(folder);
        if (errno != ERANGE)
            return NULL;
    }
    return NULL;
}

char *path_absolute(const char *path)
{
    char *folder = *path == '/' ? NULL : working_folder();
    char *whole = path_join(folder ? folder : "", path);
    free(folder);
    return whole;
}

const char *path_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

char *path_folder(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *folder = copy_text(path);
    if (folder && !slash)
        folder[0] = '\0';
    else if (folder)
        folder[slash == path ? 1 : slash - path] = '\0';
    return folder;
}

void folder_names_clear(struct folder_names *list)
{
    for (size_t i = 0; i < list->count; i++)
        free(list->names[i]);
    free(list->names);
    memset(list, 0, sizeof *list);
}

static bool add_name(struct folder_names *list, const char *name)
{
    if ((list->count & (list->count + 1)) == 0) { /* 0, 1, 3, 7...: room for twice as many */
        char **more = list->count < NAMES_MAX
                          ? realloc(list->names, (2 * list->count + 1) * sizeof *more)
                          : NULL;
        if (!more)
            return false;
        list->names = more;
    }
    list->names[list->count] = copy_text(name);
    if (!list->names[list->count])
        return false;
    list->count++;
    return true;
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static bool is_wanted(const char *name, const char *prefix)
{
    return strcmp(name, ".") != 0 && strcmp(name, "..") != 0 &&
           strncmp(name, prefix, strlen(prefix)) == 0;
}

sonject_status folder_names_read(struct folder_names *list, struct report *report, const char *path,
                                 const char *prefix)
{
    memset(list, 0, sizeof *list);
    DIR *folder = opendir(path);
    if (!folder)
        return errno == ENOENT || errno == ENOTDIR ? SONJECT_OK
                                                   : file_failure(report, path, "read", errno);
    sonject_status status = SONJECT_OK;
    struct dirent *entry;
    while (status == SONJECT_OK && (errno = 0, entry = readdir(folder)) != NULL)
        if (is_wanted(entry->d_name, prefix) && !add_name(list, entry->d_name))
            status = report_out_of_memory(report, path);
    if (status == SONJECT_OK && errno != 0)
        status = file_failure(report, path, "read", errno);
    closedir(folder);
    if (status != SONJECT_OK)
        folder_names_clear(list);
    else if (list->count > 0)
        qsort(list->names, list->count, sizeof *list->names, compare_names);
    return status;
}
