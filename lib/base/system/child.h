/* A child: a program that this one starts. Bytes pass both ways over one channel, which is the
 * child's standard input. */
#ifndef SONJECT_BASE_SYSTEM_CHILD_H
#define SONJECT_BASE_SYSTEM_CHILD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CHILD_WAITS_PER_SECOND 10

/* One end of a channel, as the system has it. */
struct channel {
    intptr_t end;
    int silence_s; /* time after which sending fails */
    void *pending; /* Windows: event to wait for; NULL: calls block */
};

/* A started program. All 0: none runs. */
struct child {
    long number, owner; /* process numbers: its own (0: none), its starter's */
    struct channel channel;
    void *process, *job; /* Windows' handles */
};

/* The end of a child. */
struct child_end {
    bool is_known;   /* false if the host has waited for it; on Windows also if it was ended here */
    bool has_exited; /* true if the child ended by itself, with status */
    int status;
    bool is_out_of_time;
    char reason[40]; /* such as " (signal 11)"; "": none */
};

/* Starts a program with one argument. The program may use memory_bytes. It gets none of this
 * process's files and streams but the channel, and no signals that are sent to all processes of a
 * job. It ends when this process ends. silence_s: sending fails if nothing is taken for so long.
 * Returns 0 or an errno: ENOENT, EACCES and ENOEXEC are about the program. */
int child_start(struct child *child, const char *program, const char *argument,
                uint64_t memory_bytes, int silence_s);

/* Forgets the child, after ending it if it still runs and this process has started it. */
struct child_end child_stop(struct child *child);

/* Sends bytes. Returns false with errno if the other end is gone, or silent for too long. */
bool channel_send(const struct channel *channel, const void *bytes, size_t count);

/* Receives at most count bytes and returns how many. 0: the other end is gone. -1 with errno:
 * EAGAIN if the process that started the child has waited for a part of a second, EINTR. */
long channel_receive(const struct channel *channel, void *bytes, size_t count);

/* ---- In the child. */

/* Closes all but the child's end of the channel, limits memory to memory_bytes, and makes the child
 * end with its starter. Returns false if the system refuses. */
bool child_begin(struct channel *channel, uint64_t memory_bytes);

/* Limits the processor time that the child may take from now on. */
void child_limit_time(int seconds);

/* Ends the child at once; nothing that is open needs saving. */
void child_exit(void);

#endif
