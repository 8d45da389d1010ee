/* Calls that fail on purpose. The linker sends the library's own calls of memory, OpenCL and files
 * here (meson.build). fault_take_jansson adds jansson's. Others go on to the real function. */
#ifndef SONJECT_TESTS_FAULTS_H
#define SONJECT_TESTS_FAULTS_H

#include <stdbool.h>

/* Declares a call under the linker's two names: the real function, and the one called instead. */
#define WRAPPED(type, name, ...)                                                                   \
    type __real_##name(__VA_ARGS__);                                                               \
    type __wrap_##name(__VA_ARGS__)

enum fault_kind {
    FAULT_MEMORY,   /* allocations */
    FAULT_OPENCL,   /* calls of OpenCL other than releases */
    FAULT_FILE,     /* calls that make, write, flush, close or rename files */
    FAULT_LIBRARIES /* allocations of the libraries under sonject, in the arming thread */
};

/* Counts calls of a kind from 0 on. Call number n (1: the next; 0: none) fails, and where `stays`
 * is set all later ones. error: the OpenCL error or the errno; 0: one that fits the call. */
void fault_arm(enum fault_kind kind, long n, bool stays, int error);

/* Lets all calls succeed again. Returns the number of calls since fault_arm. */
long fault_disarm(void);

/* Returns whether this call fails. *error gets the chosen error. The calls' wrappers use it. */
bool fault_is_due(enum fault_kind kind, int *error);

/* Begin and end a stretch of code whose allocations FAULT_LIBRARIES does not count. */
void fault_look_away(void);
void fault_look_again(void);

/* Returns whether this thread armed FAULT_LIBRARIES and is in no stretch of fault_look_away. */
bool fault_is_watched(void);

/* Return, and change, the numbers of memory blocks and of OpenCL objects that are held. */
long fault_blocks(void);
long fault_objects(void);
void fault_count_block(long change);
void fault_count_object(long change);

/* Lets jansson's memory be counted, and fail, as the library's own does. */
void fault_take_jansson(void);

#endif
