#define _POSIX_C_SOURCE 200809L
#include "swath/decoder.h"

#include <errno.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"

#define WAITS_PER_SECOND 10

extern char **environ;

/* Its wait status; -1 where the host has waited for it. */
static int end_process(struct decoder *decoder)
{
    int ended = -1;
    if (decoder->process == 0)
        return ended;
    close(decoder->socket);
    /* a host that was forked has its parent's numbers; one whose child was waited for, none */
    const bool is_ours = decoder->owner == (long)getpid();
    pid_t waited = is_ours ? waitpid((pid_t)decoder->process, &ended, WNOHANG) : -1;
    if (waited == 0) {
        kill((pid_t)decoder->process, SIGKILL);
        do
            waited = waitpid((pid_t)decoder->process, &ended, 0);
        while (waited < 0 && errno == EINTR);
    }
    decoder->process = 0;
    return waited > 0 ? ended : -1;
}

void decoder_stop(struct decoder *decoder)
{
    (void)end_process(decoder);
    decoder_state_release(&decoder->state);
}

/* It gets the socket as its standard input, and of the others nothing. Signals for all of a job's
 * processes are the host's to answer; the child ends with the socket. */
static int spawn(struct decoder *decoder, const char *program, int end)
{
    char stamp[64];
    char *arguments[] = {DECODER_PROGRAM, stamp, NULL};
    const int kept_away[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1, SIGUSR2, SIGTSTP};
    sigset_t blocked, usual;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_t actions;
    pid_t process;
    decoder_stamp(stamp);
    sigemptyset(&blocked);
    for (size_t i = 0; i < sizeof kept_away / sizeof *kept_away; i++)
        sigaddset(&blocked, kept_away[i]);
    sigemptyset(&usual);
    const int handled[] = {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU, SIGPIPE, SIGCHLD};
    for (size_t i = 0; i < sizeof handled / sizeof *handled; i++)
        sigaddset(&usual, handled[i]);
    int error = posix_spawnattr_init(&attributes);
    if (error != 0)
        return error;
    error = posix_spawn_file_actions_init(&actions);
    if (error == 0) {
        posix_spawnattr_setsigmask(&attributes, &blocked);
        posix_spawnattr_setsigdefault(&attributes, &usual);
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
        error = posix_spawn_file_actions_adddup2(&actions, end, 0);
        for (int i = 1; error == 0 && i <= 2; i++)
            error = posix_spawn_file_actions_addopen(&actions, i, "/dev/null", 1, 0);
        if (error == 0)
            error = posix_spawn(&process, program, &actions, &attributes, arguments, environ);
        posix_spawn_file_actions_destroy(&actions);
    }
    posix_spawnattr_destroy(&attributes);
    if (error == 0) {
        decoder->process = (long)process;
        decoder->owner = (long)getpid();
        decoder->starts++;
    }
    return error;
}

/* System calls that wait for longer fail. Answers are waited for in pieces, between which the
 * caller may end the call. */
static int limit_waits(int descriptor)
{
    const struct timeval limit = {DECODER_SILENCE_S, 0};
    const struct timeval piece = {0, 1000000 / WAITS_PER_SECOND};
    return setsockopt(descriptor, SOL_SOCKET, SO_RCVTIMEO, &piece, sizeof piece) == 0 &&
                   setsockopt(descriptor, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit) == 0
               ? 0
               : errno;
}

static sonject_status start(struct report *report, struct decoder *decoder, const char *path)
{
    int ends[2];
    char *program = decoder_path();
    CHECK_MEMORY(report, program, "a path");
    int error = socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) == 0 ? 0 : errno;
    sonject_status status = SONJECT_OK;
    if (error == 0) {
        error = limit_waits(ends[0]);
        if (error == 0)
            error = spawn(decoder, program, ends[1]);
        close(ends[1]);
        decoder->socket = ends[0];
        if (error != 0)
            close(ends[0]);
    }
    if (error == ENOENT || error == EACCES || error == ENOEXEC)
        status = report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                                "%s: sonject reads it by %s, which cannot be used: %s: install "
                                "sonject anew",
                                path, program, strerror(error));
    else if (error != 0)
        status = file_failure(report, program, "start", error);
    free(program);
    return status;
}

/* What came of a child that does not answer. */
static sonject_status tell_end(struct report *report, struct decoder *decoder, const char *path)
{
    const bool is_late = errno == EAGAIN || errno == EWOULDBLOCK;
    const bool is_cancelled = errno == ECANCELED;
    const int ended = end_process(decoder);
    if (is_cancelled)
        return report_failure(report, SONJECT_CANCELLED, "cancelled");
    if (ended != -1 && WIFEXITED(ended) && WEXITSTATUS(ended) == DECODER_STRANGER)
        return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                              "%s: the program " DECODER_PROGRAM
                              " is of another version of sonject: install sonject anew",
                              path);
    if (is_late || (ended != -1 && WIFSIGNALED(ended) && WTERMSIG(ended) == SIGXCPU))
        return input_failure(report, path,
                             "reading it takes longer than it can if it is sound: copy it again");
    char signal_name[32] = "";
    if (ended != -1 && WIFSIGNALED(ended))
        snprintf(signal_name, sizeof signal_name, " (signal %d)", WTERMSIG(ended));
    return input_failure(
        report, path, "is damaged: the program that reads it ended%s; copy it again", signal_name);
}

bool decoder_send(int descriptor, const void *bytes, size_t count)
{
    const char *rest = bytes;
    while (count > 0) {
        const ssize_t sent = send(descriptor, rest, count, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent < 0)
            return false;
        rest += sent;
        count -= (size_t)sent;
    }
    return true;
}

bool decoder_receive(const struct report *report, int descriptor, void *bytes, size_t count)
{
    char *rest = bytes;
    int waits = 0;
    while (count > 0) {
        const ssize_t got = recv(descriptor, rest, count, 0);
        const bool has_waited = got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK);
        if (has_waited || (got < 0 && errno == EINTR)) {
            waits += has_waited;
            if (report_is_cancelled(report))
                errno = ECANCELED;
            else if (waits < DECODER_SILENCE_S * WAITS_PER_SECOND)
                continue;
            return false;
        }
        if (got <= 0) {
            errno = got == 0 ? 0 : errno;
            return false;
        }
        waits = 0;
        rest += got;
        count -= (size_t)got;
    }
    return true;
}

static sonject_status ask_child(struct report *report, struct decoder *decoder, const char *path,
                                const struct decoder_request *request, const void *in,
                                struct decoder_reply *reply, void *out, size_t capacity)
{
    char message[REPORT_CAPACITY] = "";
    if (!decoder_send(decoder->socket, request, sizeof *request) ||
        !decoder_send(decoder->socket, in, (size_t)request->bytes) ||
        !decoder_receive(report, decoder->socket, reply, sizeof *reply))
        return tell_end(report, decoder, path);
    const bool is_good = reply->status == SONJECT_OK;
    errno = 0;
    if (reply->bytes > (is_good ? capacity : sizeof message - 1) ||
        !decoder_receive(report, decoder->socket, is_good ? out : message, (size_t)reply->bytes))
        return tell_end(report, decoder, path);
    const bool is_known = is_good || reply->status == SONJECT_ERROR_STORAGE ||
                          reply->status == SONJECT_ERROR_MEMORY ||
                          reply->status == SONJECT_ERROR_UNSUPPORTED;
    const sonject_status status = is_known ? (sonject_status)reply->status : SONJECT_ERROR_INPUT;
    return is_good ? status : report_failure(report, status, "%s", message);
}

static sonject_status ask_here(struct report *report, struct decoder *decoder, const char *path,
                               const struct decoder_request *request, const void *in,
                               struct decoder_reply *reply, void *out, size_t capacity)
{
    void *made = NULL;
    if (!decoder->state)
        decoder->state = decoder_state_make();
    CHECK_MEMORY(report, decoder->state, path);
    const sonject_status status = decoder_answer(report, decoder->state, request, in, reply, &made);
    if (reply->bytes > capacity)
        reply->bytes = 0;
    if (reply->bytes > 0)
        memcpy(out, made, (size_t)reply->bytes);
    free(made);
    return status;
}

sonject_status decoder_start(struct report *report, struct decoder *decoder, const char *path)
{
    if (decoder->is_in_process)
        return SONJECT_OK;
    if (decoder->owner != (long)getpid())
        (void)end_process(decoder);
    return decoder->process == 0 ? start(report, decoder, path) : SONJECT_OK;
}

sonject_status decoder_ask(struct report *report, struct decoder *decoder, const char *path,
                           const struct decoder_request *request, const void *in,
                           struct decoder_reply *reply, void *out, size_t capacity, size_t *count)
{
    memset(reply, 0, sizeof *reply);
    const sonject_status status = (decoder->is_in_process ? ask_here : ask_child)(
        report, decoder, path, request, in, reply, out, capacity);
    *count = status == SONJECT_OK ? (size_t)reply->bytes : 0;
    return status;
}
