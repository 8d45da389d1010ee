/* Makes call number FAULT_PREAD of pread fail as on a broken disk; loaded before a program. */
#undef _FILE_OFFSET_BITS /* the macro would turn pread into pread64 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

ssize_t pread(int descriptor, void *bytes, size_t count, off_t place);
ssize_t pread64(int descriptor, void *bytes, size_t count, off_t place);

static ssize_t read_or_fail(const char *name, int descriptor, void *bytes, size_t count,
                            off_t place)
{
    static long calls;
    ssize_t (*real)(int, void *, size_t, off_t);
    void *found = dlsym(RTLD_NEXT, name);
    __builtin_memcpy(&real, &found, sizeof real);
    const char *due = getenv("FAULT_PREAD");
    if (!due || ++calls != atol(due))
        return real(descriptor, bytes, count, place);
    errno = EIO;
    return -1;
}

ssize_t pread(int descriptor, void *bytes, size_t count, off_t place)
{
    return read_or_fail("pread", descriptor, bytes, count, place);
}

ssize_t pread64(int descriptor, void *bytes, size_t count, off_t place)
{
    return read_or_fail("pread64", descriptor, bytes, count, place);
}
