#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64
#include "io/byte_file.h"

#include <errno.h>
#include <stdlib.h>
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

bool byte_ranges_add(struct byte_ranges *ranges, uint64_t place, uint64_t count)
{
    struct byte_range *last = ranges->count > 0 ? &ranges->list[ranges->count - 1] : NULL;
    if (last && last->place + last->count == place) {
        last->count += count;
        return true;
    }
    if (ranges->count == ranges->capacity) {
        const size_t capacity = ranges->capacity > 0 ? 2 * ranges->capacity : 16;
        struct byte_range *larger = capacity < SIZE_MAX / sizeof *larger
                                        ? realloc(ranges->list, capacity * sizeof *larger)
                                        : NULL;
        if (!larger)
            return false;
        ranges->list = larger;
        ranges->capacity = capacity;
    }
    ranges->list[ranges->count].place = place;
    ranges->list[ranges->count++].count = count;
    return true;
}
