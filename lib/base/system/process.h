/* What is asked of the system's processes, threads and clocks. */
#ifndef SONJECT_BASE_SYSTEM_PROCESS_H
#define SONJECT_BASE_SYSTEM_PROCESS_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* How names of programs end. */
#ifdef _WIN32
#define PROGRAM_ENDING ".exe"
#else
#define PROGRAM_ENDING ""
#endif

/* ---- This process. */

long process_number(void);

/* Names where this process's number means something: the host, and on Linux the space of process
 * numbers that a container has for itself. */
uint32_t process_place(void);

/* Whether a process of this place has ended. */
bool process_has_ended(long number);

/* Random where the system gives random bytes. Process number, clocks and stack address keep
 * processes and threads apart where it does not. */
uint64_t unique_number(void);

/* Seconds on a clock that nobody sets. */
double clock_seconds(void);

/* What it has used at most so far; 0: the system does not tell. */
uint64_t peak_memory_bytes(void);

/* From now on begin_child is called in children that are forked from this process, first thing. */
void forks_watch(void (*begin_child)(void));

/* ---- Threads. */

/* That this process may use, 1 at least. */
uint32_t processor_count(void);

/* Starts a thread that receives no signals, which are the host's threads' to receive. False: the
 * system has none. */
bool thread_start(pthread_t *thread, void *(*run)(void *user), void *user);

/* For the condition, a fifth of a second at most. */
void wait_a_little(pthread_cond_t *condition, pthread_mutex_t *lock);

/* ---- Libraries. */

/* A library of the system's, by its name and the number of its interface, loaded to stay; NULL:
 * there is none, or no memory for it. */
void *library_load(const char *name, int number);

/* NULL: the library has no such function. */
void *library_function(void *library, const char *name);

/* The folder of the library, or the program that it is part of, in which an address lies; to be
 * given to free(), NULL when memory is out, "" where it is not known. */
char *folder_of_code(const void *address);

/* ---- A program at a terminal. */

/* To be called first in main. Opens the missing ones of the standard streams, so that no image file
 * gets their place and messages end up in it; what is written to an output that was closed still
 * fails. Makes the arguments UTF-8, and keeps freed memory for what is allocated next. */
void program_begin(int *count, char ***arguments);

/* From now on note is called for SIGTERM and SIGINT; a second SIGINT ends the process. */
void signals_watch(void (*note)(int number));

/* Whether messages go to a terminal. */
bool errors_are_shown(void);

#endif
