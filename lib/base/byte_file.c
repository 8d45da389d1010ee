#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64
#include "base/byte_file.h"

#include <errno.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include "base/file.h"

FILE *byte_file_open(const char *path, uint64_t *bytes)
{
    struct stat facts;
    const int descriptor = file_open(path);
    FILE *file = descriptor >= 0 ? fdopen(descriptor, "rb") : NULL;
    if (!file || fstat(descriptor, &facts) != 0) {
        const int error = errno;
        if (file)
            fclose(file);
        else if (descriptor >= 0)
            close(descriptor);
        errno = error;
        return NULL;
    }
    *bytes = (uint64_t)facts.st_size;
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
