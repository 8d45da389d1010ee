#define _DEFAULT_SOURCE /* for syscall */
#include "base/system/child.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#define CHANNEL         0 /* a child's standard input */
#define DESCRIPTORS_MAX 65536

extern char **environ;

/* Blocks signals to all of a job's processes, which the host answers. Others work as usual. */
static void choose_signals(posix_spawnattr_t *attributes)
{
    const int kept_away[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1, SIGUSR2, SIGTSTP};
    const int handled[] = {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU, SIGPIPE, SIGCHLD};
    sigset_t blocked, usual;
    sigemptyset(&blocked);
    for (size_t i = 0; i < sizeof kept_away / sizeof *kept_away; i++)
        sigaddset(&blocked, kept_away[i]);
    sigemptyset(&usual);
    for (size_t i = 0; i < sizeof handled / sizeof *handled; i++)
        sigaddset(&usual, handled[i]);
    posix_spawnattr_setsigmask(attributes, &blocked);
    posix_spawnattr_setsigdefault(attributes, &usual);
    posix_spawnattr_setflags(attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
}

static int spawn(struct child *child, const char *program, const char *argument, int end)
{
    const char *slash = strrchr(program, '/');
    char name[64], given[64];
    char *arguments[] = {name, given, NULL};
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_t actions;
    pid_t process;
    snprintf(name, sizeof name, "%s", slash ? slash + 1 : program);
    snprintf(given, sizeof given, "%s", argument);
    int error = posix_spawnattr_init(&attributes);
    if (error != 0)
        return error;
    error = posix_spawn_file_actions_init(&actions);
    if (error == 0) {
        choose_signals(&attributes);
        error = posix_spawn_file_actions_adddup2(&actions, end, CHANNEL);
        for (int i = 1; error == 0 && i <= 2; i++)
            error = posix_spawn_file_actions_addopen(&actions, i, "/dev/null", 1, 0);
        if (error == 0)
            error = posix_spawn(&process, program, &actions, &attributes, arguments, environ);
        posix_spawn_file_actions_destroy(&actions);
    }
    posix_spawnattr_destroy(&attributes);
    if (error == 0) {
        child->number = (long)process;
        child->owner = (long)getpid();
    }
    return error;
}

/* Limits waits. Answers are awaited in pieces, between which the caller may end the call. */
static int limit_waits(int socket, int silence_s)
{
    const struct timeval limit = {silence_s, 0};
    const struct timeval piece = {0, 1000000 / CHILD_WAITS_PER_SECOND};
    return setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &piece, sizeof piece) == 0 &&
                   setsockopt(socket, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit) == 0
               ? 0
               : errno;
}

int child_start(struct child *child, const char *program, const char *argument,
                uint64_t memory_bytes, int silence_s)
{
    int ends[2];
    (void)memory_bytes; /* the child limits itself */
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        return errno;
    int error = limit_waits(ends[0], silence_s);
    if (error == 0)
        error = spawn(child, program, argument, ends[1]);
    close(ends[1]);
    child->channel.end = ends[0];
    if (error != 0)
        close(ends[0]);
    return error;
}

struct child_end child_stop(struct child *child)
{
    struct child_end end = {0};
    int status = 0;
    if (child->number == 0)
        return end;
    close((int)child->channel.end);
    /* not ours after a fork; waited is -1 if the host itself has waited for the child */
    const bool is_ours = child->owner == (long)getpid();
    pid_t waited = is_ours ? waitpid((pid_t)child->number, &status, WNOHANG) : -1;
    if (waited == 0) {
        kill((pid_t)child->number, SIGKILL);
        do
            waited = waitpid((pid_t)child->number, &status, 0);
        while (waited < 0 && errno == EINTR);
    }
    child->number = 0;
    end.is_known = waited > 0;
    end.has_exited = end.is_known && WIFEXITED(status);
    end.status = end.has_exited ? WEXITSTATUS(status) : 0;
    if (end.is_known && WIFSIGNALED(status)) {
        end.is_out_of_time = WTERMSIG(status) == SIGXCPU;
        snprintf(end.reason, sizeof end.reason, " (signal %d)", WTERMSIG(status));
    }
    return end;
}

bool channel_send(const struct channel *channel, const void *bytes, size_t count)
{
    const char *rest = bytes;
    while (count > 0) {
        const ssize_t sent = send((int)channel->end, rest, count, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent < 0)
            return false;
        rest += sent;
        count -= (size_t)sent;
    }
    return true;
}

long channel_receive(const struct channel *channel, void *bytes, size_t count)
{
    const ssize_t got = recv((int)channel->end, bytes, count, 0);
    if (got < 0 && errno == EWOULDBLOCK)
        errno = EAGAIN;
    return (long)got;
}

static void close_all_but_standard(void)
{
#ifdef SYS_close_range
    if (syscall(SYS_close_range, 3U, ~0U, 0U) == 0)
        return;
#endif
    const long most = sysconf(_SC_OPEN_MAX);
    for (int i = 3; i < DESCRIPTORS_MAX && (most < 0 || i < most); i++)
        close(i);
}

static void limit(int resource, rlim_t amount)
{
    struct rlimit limits;
    if (getrlimit(resource, &limits) != 0)
        return;
    if (limits.rlim_max == RLIM_INFINITY || amount < limits.rlim_max)
        limits.rlim_cur = amount;
    setrlimit(resource, &limits);
}

/* Ends the child with the channel: the library's process may end during a request. */
static void *end_with_the_channel(void *unused)
{
    struct pollfd watched = {CHANNEL, 0, 0};
    (void)unused;
    while (poll(&watched, 1, -1) <= 0)
        continue;
    _exit(0);
}

bool child_begin(struct channel *channel, uint64_t memory_bytes)
{
    pthread_t watcher;
    channel->end = CHANNEL;
    close_all_but_standard();
    limit(RLIMIT_CORE, 0);
    if (memory_bytes > 0)
        limit(RLIMIT_AS, (rlim_t)memory_bytes);
    return pthread_create(&watcher, NULL, end_with_the_channel, NULL) == 0;
}

void child_limit_time(int seconds)
{
    struct rusage used;
    if (getrusage(RUSAGE_SELF, &used) == 0)
        limit(RLIMIT_CPU,
              (rlim_t)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + 1 + (rlim_t)seconds);
}

void child_exit(void)
{
    _exit(0);
}
