/* The system's processes, threads and clocks. */
#ifndef SONJECT_BASE_SYSTEM_PROCESS_H
#define SONJECT_BASE_SYSTEM_PROCESS_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The ending of programs' names. */
#ifdef _WIN32
#define PROGRAM_ENDING ".exe"
#else
#define PROGRAM_ENDING ""
#endif

/* ---- This process. */

long process_number(void);

/* Names the place in which process numbers are unique: the host, and on Linux a container's own
 * space of process numbers. */
uint32_t process_place(void);

/* Returns whether a process of this place has ended. */
bool process_has_ended(long number);

/* Returns a random number if the system gives random bytes. Process number, clocks and stack
 * address keep processes and threads apart otherwise. */
uint64_t unique_number(void);

/* Returns the seconds of a clock that nobody sets. */
double clock_seconds(void);

/* Returns the most memory that this process has used so far; 0 if the system does not tell. */
uint64_t peak_memory_bytes(void);

/* Calls begin_child from now on in children forked from this process, first thing. */
void forks_watch(void (*begin_child)(void));

/* ---- Threads. */

/* Returns the number of processors that this process may use, at least 1. */
uint32_t processor_count(void);

/* Starts a thread that receives no signals, which are for the host's threads. Returns false if the
 * system has no thread. */
bool thread_start(pthread_t *thread, void *(*run)(void *user), void *user);

/* Waits for the condition, a fifth of a second at most. */
void wait_a_little(pthread_cond_t *condition, pthread_mutex_t *lock);

/* ---- Libraries. */

/* Loads a library of the system by name and interface number, to stay. Returns NULL if there is
 * none, or no memory for it. */
void *library_load(const char *name, int number);

/* Returns NULL if the library has no such function. */
void *library_function(void *library, const char *name);

/* Returns the folder of the library, or of the program that it is part of, in which an address
 * lies. For free(); NULL if out of memory, "" if unknown. */
char *folder_of_code(const void *address);

/* ---- A program at a terminal. */

/* Must be called first in main. Opens missing standard streams, so that no image file gets their
 * place and receives messages. Writing to an output that was closed still fails. Makes the
 * arguments UTF-8, and keeps freed memory for later allocations. */
void program_begin(int *count, char ***arguments);

/* Calls note from now on for SIGTERM and SIGINT. A second SIGINT ends the process. */
void signals_watch(void (*note)(int number));

/* Returns whether messages go to a terminal. */
bool errors_are_shown(void);

#endif
