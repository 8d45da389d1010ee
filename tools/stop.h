/* Asking a long run to stop: SIGTERM and SIGINT. */
#ifndef SONJECT_TOOLS_STOP_H
#define SONJECT_TOOLS_STOP_H

#include "exit_code.h"

/* From now on SIGTERM and SIGINT are only noted; a second SIGINT ends the process. */
void stop_watch(void);

/* 1 once a signal came. */
int stop_is_asked(void);

/* Says that the run stopped; exit code for the signal that came. */
int stop_report(void);

#endif
