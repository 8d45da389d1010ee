/* A program that this one starts and talks to: bytes there and back, over one channel, which is the
 * program's standard input. */
#ifndef SONJECT_BASE_SYSTEM_CHILD_H
#define SONJECT_BASE_SYSTEM_CHILD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CHILD_WAITS_PER_SECOND 10

/* One end of a channel, as the system has it. */
struct channel {
    intptr_t end;
    int silence_s; /* after which sending fails */
    void *pending; /* what Windows waits for; NULL: all calls wait */
};

/* All 0: none runs. */
struct child {
    long number, owner; /* 0: none; who started it */
    struct channel channel;
    void *process, *job; /* as Windows knows it */
};

/* How a child ended. */
struct child_end {
    bool is_known;   /* else the host has waited for it, or it was ended here */
    bool has_exited; /* by itself, with this status */
    int status;
    bool is_out_of_time;
    char reason[40]; /* " (signal 11)"; "": there is none */
};

/* Starts a program with an argument. It may use so much memory, gets of this process's files and
 * streams but the channel, and receives no signals that are sent to all processes of a job. It is
 * ended when this process ends. Returns 0 or an errno: ENOENT, EACCES and ENOEXEC are the program's
 * own. silence_s: what is sent fails where nothing is taken for so long. */
int child_start(struct child *child, const char *program, const char *argument,
                uint64_t memory_bytes, int silence_s);

/* Ends the child, if this process has started it and it still runs, and forgets it. */
struct child_end child_stop(struct child *child);

/* False with errno where the other end is gone or silent for too long. */
bool channel_send(const struct channel *channel, const void *bytes, size_t count);

/* The number of bytes that came, at most count; 0: the other end is gone. -1 with errno: EAGAIN
 * where the one who started the child has waited for a part of a second, EINTR. */
long channel_receive(const struct channel *channel, void *bytes, size_t count);

/* ---- In the child. */

/* Its end of the channel, once it has but that and so much memory, and ends with the one who
 * started it. False: the system refuses. */
bool child_begin(struct channel *channel, uint64_t memory_bytes);

/* From now on it may compute for so long. */
void child_limit_time(int seconds);

/* Ends it at once: what is open has nothing to be saved. */
void child_exit(void);

#endif
