/* Calls that fail on purpose. The linker sends the library's own calls for memory (and jansson's),
 * of OpenCL and of files here (meson.build); what is not to fail goes on to where it was meant. */
#ifndef SONJECT_TESTS_FAULTS_H
#define SONJECT_TESTS_FAULTS_H

#include <stdbool.h>

/* A call as the linker names what was meant and what is called instead. */
#define WRAPPED(type, name, ...)                                                                   \
    type __real_##name(__VA_ARGS__);                                                               \
    type __wrap_##name(__VA_ARGS__)

enum fault_kind {
    FAULT_MEMORY,   /* allocations */
    FAULT_OPENCL,   /* calls of OpenCL other than releases */
    FAULT_FILE,     /* calls that make, write, flush, close or rename files */
    FAULT_LIBRARIES /* allocations of the libraries below, in the thread that arms them */
};

/* Counts calls of that kind from 0 on, of which number n (1: the next) fails, and where `stays`
 * all after it; n = 0: none. error: the OpenCL error or the errno; 0: one that fits the call. */
void fault_arm(enum fault_kind kind, long n, bool stays, int error);

/* Lets all calls succeed again; returns how many there were since fault_arm. */
long fault_disarm(void);

/* Whether this call fails; *error gets the chosen error. For the calls' own wrappers. */
bool fault_is_due(enum fault_kind kind, int *error);

/* Around what is not a library's own doing: within, its allocations count as nobody's. */
void fault_look_away(void);
void fault_look_again(void);

/* Whether this thread armed FAULT_LIBRARIES and is not within what is looked away from. */
bool fault_is_watched(void);

/* Blocks of memory that are held, and OpenCL objects. */
long fault_blocks(void);
long fault_objects(void);
void fault_count_block(long change);
void fault_count_object(long change);

/* Lets jansson's memory be counted, and fail, as the library's. */
void fault_take_jansson(void);

#endif
