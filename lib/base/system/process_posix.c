#define _GNU_SOURCE /* for sched_getaffinity, dladdr */
#include "base/system/process.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

long process_number(void)
{
    return (long)getpid();
}

uint32_t process_place(void)
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

bool process_has_ended(long number)
{
    return kill((pid_t)number, 0) != 0 && errno == ESRCH;
}

uint64_t unique_number(void)
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

double clock_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

uint64_t peak_memory_bytes(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? 1024 * (uint64_t)usage.ru_maxrss : 0;
}

void forks_watch(void (*begin_child)(void))
{
    pthread_atfork(NULL, NULL, begin_child);
}

uint32_t processor_count(void)
{
    cpu_set_t set; /* batch systems give a job a few of many */
    const long count = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set)
                                                                   : sysconf(_SC_NPROCESSORS_ONLN);
    return count < 1 ? 1 : (uint32_t)count;
}

bool thread_start(pthread_t *thread, void *(*run)(void *user), void *user)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const bool is_started = pthread_create(thread, NULL, run, user) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return is_started;
}

void *library_load(const char *name, int number)
{
    char file[256];
    snprintf(file, sizeof file, "lib%s.so.%d", name, number);
    return dlopen(file, RTLD_NOW | RTLD_LOCAL);
}

void *library_function(void *library, const char *name)
{
    return dlsym(library, name);
}

char *folder_of_code(const void *address)
{
    Dl_info library;
    char program[4096] = "";
    const bool is_named = /* a program may be known by its name alone */
        dladdr(address, &library) != 0 && library.dli_fname && strchr(library.dli_fname, '/');
    if (!is_named && readlink("/proc/self/exe", program, sizeof program - 1) < 0)
        program[0] = '\0';
    char *folder = strdup(is_named ? library.dli_fname : program);
    char *slash = folder ? strrchr(folder, '/') : NULL;
    if (slash)
        slash[slash == folder] = '\0';
    return folder;
}

/* Keeps freed memory in the process. Each image of a campaign takes megabytes and frees them. glibc
 * would return them to the system, which clears them for the next image: a tenth of a campaign's
 * time. The heap begins with large pages, which the system makes at once, not 4 KB at a time: a
 * seventh of a short run's time. */
static void keep_freed_memory(void)
{
#ifdef __GLIBC__
    enum {
        LARGE_PAGE = 2 << 20,
        HEAP = 256 << 20
    };
    mallopt(M_MMAP_THRESHOLD, 32 << 20);
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
    mallopt(M_TOP_PAD, HEAP);
    char *first = malloc(1 << 20); /* more than the heap has so far */
    mallopt(M_TOP_PAD, 0);
    if (first)
        madvise(first + (-(uintptr_t)first & (LARGE_PAGE - 1)), HEAP - LARGE_PAGE, MADV_HUGEPAGE);
    free(first);
#endif
}

void program_begin(int *count, char ***arguments)
{
    /* Modes are the wrong way round: reading the input or writing the output must fail. */
    const int flags[] = {O_WRONLY, O_RDONLY, O_RDONLY};
    (void)count, (void)arguments;
    keep_freed_memory();
    for (int descriptor = 0; descriptor <= 2; descriptor++) {
        if (fcntl(descriptor, F_GETFD) != -1)
            continue;
        const int opened = open("/dev/null", flags[descriptor]);
        if (opened != -1 && opened != descriptor) {
            dup2(opened, descriptor);
            close(opened);
        }
    }
}

void signals_watch(void (*note)(int number))
{
    const int numbers[] = {SIGTERM, SIGINT};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        struct sigaction action;
        memset(&action, 0, sizeof action);
        action.sa_handler = note;
        /* No signal may make writing a file fail. A second SIGINT ends the command at once. SIGTERM
         * comes twice from schedulers that signal a job's script, which passes it on, and the
         * script's processes. */
        action.sa_flags = (int)(numbers[i] == SIGINT ? SA_RESTART | SA_RESETHAND : SA_RESTART);
        sigemptyset(&action.sa_mask);
        sigaction(numbers[i], &action, NULL);
    }
}

bool errors_are_shown(void)
{
    return isatty(STDERR_FILENO);
}
