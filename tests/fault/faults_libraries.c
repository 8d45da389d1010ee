/* The process's own allocators in place of glibc's. The libraries under sonject call them: libyaml,
 * the C library, and libraries that test_calls.c leaves out. Three kinds of allocations are not
 * counted: sonject's own, which faults_memory.c fails; the OpenCL driver's, whose compiler ends the
 * process when it gets no memory; other threads', since nobody could tell what these do next. */
#define _GNU_SOURCE
#include "faults.h"

#include <errno.h>
#include <stddef.h>

void *__libc_malloc(size_t bytes);
void *__libc_calloc(size_t count, size_t bytes);
void *__libc_realloc(void *block, size_t bytes);
void *__libc_memalign(size_t alignment, size_t bytes);
void __libc_free(void *block);
void *malloc(size_t bytes);
void *calloc(size_t count, size_t bytes);
void *realloc(void *block, size_t bytes);
void *memalign(size_t alignment, size_t bytes);
void *aligned_alloc(size_t alignment, size_t bytes);
int posix_memalign(void **block, size_t alignment, size_t bytes);
void free(void *block);

static bool is_out_of_memory(void)
{
    int error;
    if (!fault_is_watched() || !fault_is_due(FAULT_LIBRARIES, &error))
        return false;
    errno = ENOMEM;
    return true;
}

void *malloc(size_t bytes)
{
    return is_out_of_memory() ? NULL : __libc_malloc(bytes);
}

void *calloc(size_t count, size_t bytes)
{
    return is_out_of_memory() ? NULL : __libc_calloc(count, bytes);
}

void *realloc(void *block, size_t bytes)
{
    return bytes > 0 && is_out_of_memory() ? NULL : __libc_realloc(block, bytes);
}

void *memalign(size_t alignment, size_t bytes)
{
    return is_out_of_memory() ? NULL : __libc_memalign(alignment, bytes);
}

void *aligned_alloc(size_t alignment, size_t bytes)
{
    return memalign(alignment, bytes);
}

int posix_memalign(void **block, size_t alignment, size_t bytes)
{
    void *made = memalign(alignment, bytes);
    if (made)
        *block = made;
    return made ? 0 : ENOMEM;
}

void free(void *block)
{
    __libc_free(block);
}
