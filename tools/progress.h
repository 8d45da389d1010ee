/* The progress bar, on a terminal's standard error output only. */
#ifndef SONJECT_TOOLS_PROGRESS_H
#define SONJECT_TOOLS_PROGRESS_H

#include <stdbool.h>

struct progress {
    bool is_shown;
    bool is_on_screen; /* a bar stands in the terminal's last line */
    double start_s;
    double drawn_s;
};

void progress_begin(struct progress *progress, bool is_quiet);

/* A sonject_progress_function; user: struct progress. Cancels once a signal asks to stop. */
int progress_update(void *user, double fraction, const char *stage);

/* A sonject_log_function; user: struct progress. Prints the line, the bar comes back below it. */
void progress_log(void *user, const char *line);

/* Removes the bar. */
void progress_end(struct progress *progress);

#endif
