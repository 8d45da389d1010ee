#define _GNU_SOURCE
#include "faults.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define MARK_ERROR 0x20 /* glibc's _IO_ERR_SEEN, since the wrapped call is glibc's */

WRAPPED(int, open64, const char *path, int flags, ...);
WRAPPED(ssize_t, write, int descriptor, const void *bytes, size_t count);
WRAPPED(int, close, int descriptor);
WRAPPED(int, fsync, int descriptor);
WRAPPED(int, rename, const char *from, const char *to);
WRAPPED(int, mkdir, const char *path, mode_t mode);
WRAPPED(FILE *, fopen64, const char *path, const char *mode);
WRAPPED(size_t, fwrite, const void *bytes, size_t size, size_t count, FILE *file);
WRAPPED(int, fclose, FILE *file);

/* Returns whether the call fails, with errno set. usual: the errno if fault_arm chose none. */
static bool fails(int usual)
{
    int error;
    if (!fault_is_due(FAULT_FILE, &error))
        return false;
    errno = error ? error : usual;
    return true;
}

static bool is_for_writing(int descriptor)
{
    return (fcntl(descriptor, F_GETFL) & O_ACCMODE) != O_RDONLY;
}

/* True for a device's path. Calls on devices never fail. */
static bool is_device(const char *path)
{
    return strncmp(path, "/dev/", 5) == 0 && strncmp(path, "/dev/shm/", 9) != 0;
}

int __wrap_open64(const char *path, int flags, ...)
{
    va_list more;
    va_start(more, flags);
    const mode_t mode = flags & O_CREAT ? va_arg(more, mode_t) : 0;
    va_end(more);
    if (!is_device(path) && fails(flags & O_CREAT ? ENOSPC : EMFILE))
        return -1;
    return __real_open64(path, flags, mode);
}

ssize_t __wrap_write(int descriptor, const void *bytes, size_t count)
{
    return fails(ENOSPC) ? -1 : __real_write(descriptor, bytes, count);
}

int __wrap_close(int descriptor)
{
    const bool counts = is_for_writing(descriptor);
    const int result = __real_close(descriptor);
    return counts && fails(ENOSPC) ? -1 : result;
}

int __wrap_fsync(int descriptor)
{
    return fails(EIO) ? -1 : __real_fsync(descriptor);
}

int __wrap_rename(const char *from, const char *to)
{
    return fails(ENOSPC) ? -1 : __real_rename(from, to);
}

int __wrap_mkdir(const char *path, mode_t mode)
{
    return fails(EROFS) ? -1 : __real_mkdir(path, mode);
}

FILE *__wrap_fopen64(const char *path, const char *mode)
{
    if (!is_device(path) && fails(strpbrk(mode, "wa+") ? ENOSPC : EMFILE))
        return NULL;
    return __real_fopen64(path, mode);
}

/* Marks the stream as failed, as a real failure does, for callers that ask only at the end. */
size_t __wrap_fwrite(const void *bytes, size_t size, size_t count, FILE *file)
{
    if (!fails(ENOSPC))
        return __real_fwrite(bytes, size, count, file);
    file->_flags |= MARK_ERROR;
    return 0;
}

int __wrap_fclose(FILE *file)
{
    const bool counts = is_for_writing(fileno(file));
    const int result = __real_fclose(file);
    return counts && fails(ENOSPC) ? EOF : result;
}
