/* What the command's exit status says. */
#ifndef SONJECT_TOOLS_EXIT_CODE_H
#define SONJECT_TOOLS_EXIT_CODE_H

#include <sonject/sonject.h>

enum exit_code {
    EXIT_CODE_DONE = 0,
    EXIT_CODE_USAGE = 2,
    EXIT_CODE_INPUT = 3,        /* a file, scene or image; or this build lacks what it needs */
    EXIT_CODE_DEVICE = 4,       /* OpenCL */
    EXIT_CODE_STORAGE = 5,      /* reading or writing files, or out of memory */
    EXIT_CODE_STOPPED = 85,     /* SIGTERM: the same command again finishes the work */
    EXIT_CODE_INTERRUPTED = 130 /* SIGINT */
};

int exit_code_of(sonject_status status);

/* Prints the message of a call that failed and gives its exit code. */
int fail_with(const sonject_context *context, sonject_status status);

/* Flushes what went to standard output; says so where it did not arrive. */
int finish_output(void);

#endif
