/* Output and end of the command: messages, exit codes, the progress bar, and signals that ask it to
 * stop. */
#ifndef SONJECT_TOOLS_CONSOLE_H
#define SONJECT_TOOLS_CONSOLE_H

#include <stdbool.h>

#include <sonject/sonject.h>

/* Prints "sonject: ", the texts up to a NULL, and a newline, as one line whatever the texts hold.
 */
#define message(...) message_line((const char *const[]){__VA_ARGS__, NULL})

void message_line(const char *const *texts);

enum exit_code {
    EXIT_CODE_DONE = 0,
    EXIT_CODE_USAGE = 2,
    EXIT_CODE_INPUT = 3, /* an unusable file, scene or image, or a feature that this build lacks */
    EXIT_CODE_DEVICE = 4,
    EXIT_CODE_STORAGE = 5,      /* reading or writing files, or out of memory */
    EXIT_CODE_STOPPED = 85,     /* SIGTERM: the same command again continues the work */
    EXIT_CODE_INTERRUPTED = 130 /* SIGINT */
};

int exit_code_of(sonject_status status);

/* Prints the message of a failed call and returns its exit code. */
int fail_with(const sonject_context *context, sonject_status status);

/* Flushes the standard output; prints a message if that failed. Returns the exit code. */
int finish_output(void);

/* ---- Asking a long run to stop: SIGTERM and SIGINT. */

/* Makes SIGTERM and SIGINT be noted only; a second SIGINT ends the process. */
void stop_watch(void);

/* Returns 1 once a signal came. */
int stop_is_asked(void);

/* Prints that the run stopped; returns the exit code for the signal. */
int stop_report(void);

/* ---- The progress bar, on a terminal's standard error output only. */

struct progress {
    bool is_shown;
    bool is_on_screen; /* a bar stands in the terminal's last line */
    double start_s;
    double drawn_s;
};

void progress_begin(struct progress *progress, bool is_quiet);

/* A sonject_progress_function; user: struct progress. It cancels once a signal asks to stop. */
int progress_update(void *user, double fraction, const char *stage);

/* A sonject_log_function; user: struct progress, or NULL. It prints the line; the bar comes back
 * below the line. */
void progress_log(void *user, uint32_t level, const char *line);

/* A sonject_log_function as progress_log, for notes alone. */
void progress_note(void *user, uint32_t level, const char *line);

/* Removes the bar. */
void progress_end(struct progress *progress);

#endif
