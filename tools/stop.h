/* Asking a long run to stop: SIGTERM and SIGINT. */
#ifndef SONJECT_TOOLS_STOP_H
#define SONJECT_TOOLS_STOP_H

#include "exit_code.h"

/* From now on the first SIGTERM or SIGINT is only noted; another one ends the process. */
void stop_watch(void);

/* 1 once a signal came. */
int stop_is_asked(void);

/* Says that the run stopped; exit code for the signal that came. */
int stop_report(void);

#endif
