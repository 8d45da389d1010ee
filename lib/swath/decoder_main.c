/* The program sonject-decoder: answers what the library asks, over the socket that is its standard
 * input, until that ends. */
#define _POSIX_C_SOURCE 200809L
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#include "swath/decoder.h"

#define SOCKET          0
#define DESCRIPTORS_MAX 65536

static void close_all_but_standard(void)
{
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

/* The next request has its own. */
static void limit_time(void)
{
    struct rusage used;
    if (getrusage(RUSAGE_SELF, &used) == 0)
        limit(RLIMIT_CPU,
              (rlim_t)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + 1 + DECODER_CPU_S);
}

/* The library's process may end while a request is worked at. */
static void *end_with_the_socket(void *unused)
{
    struct pollfd watched = {SOCKET, 0, 0};
    (void)unused;
    while (poll(&watched, 1, -1) <= 0)
        continue;
    _exit(0);
}

static bool serve(struct decoder_state *state)
{
    struct report report = {{0}, NULL, NULL};
    struct decoder_request request;
    struct decoder_reply reply;
    void *out = NULL;
    if (!decoder_receive(&report, SOCKET, &request, sizeof request))
        return false;
    limit_time();
    memset(&reply, 0, sizeof reply);
    char *in = malloc((size_t)request.bytes + 1);
    bool goes_on = in && decoder_receive(&report, SOCKET, in, (size_t)request.bytes);
    if (goes_on) {
        reply.status = (int32_t)decoder_answer(&report, state, &request, in, &reply, &out);
        if (reply.status != SONJECT_OK)
            reply.bytes = strlen(report.message);
        goes_on = decoder_send(SOCKET, &reply, sizeof reply) &&
                  decoder_send(SOCKET, out ? out : report.message, (size_t)reply.bytes);
    }
    free(out);
    free(in);
    return goes_on;
}

int main(int count, char **arguments)
{
    char stamp[64];
    pthread_t watcher;
    decoder_stamp(stamp);
    if (count != 2 || strcmp(arguments[1], stamp) != 0) {
        fputs("sonject-decoder: is started by the library sonject, of its own version\n", stderr);
        return DECODER_STRANGER;
    }
    close_all_but_standard();
    limit(RLIMIT_CORE, 0);
#ifndef IS_SANITIZED /* sanitizers keep terabytes of addresses for themselves */
    limit(RLIMIT_AS, (rlim_t)DECODER_MEMORY_BYTES);
#endif
    struct decoder_state *state = decoder_state_make();
    if (!state || pthread_create(&watcher, NULL, end_with_the_socket, NULL) != 0)
        return 1;
    while (serve(state))
        continue;
    _exit(0); /* what is open has nothing to be saved */
}
