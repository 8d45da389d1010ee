#define _POSIX_C_SOURCE 200809L

#include "stop.h"

#include <signal.h>
#include <string.h>

#include "message.h"

static volatile sig_atomic_t signal_that_came;

static void note_signal(int number)
{
    signal_that_came = number;
}

void stop_watch(void)
{
    const int numbers[] = {SIGTERM, SIGINT};
    for (size_t i = 0; i < sizeof(numbers) / sizeof(numbers[0]); i++) {
        struct sigaction action;
        memset(&action, 0, sizeof(action));
        action.sa_handler = note_signal;
        /* Writing a file is not to fail because a signal came. A second SIGINT ends the command at
         * once; SIGTERM comes twice from schedulers that signal a job's script, which hands it on,
         * and its processes. */
        action.sa_flags = (int)(numbers[i] == SIGINT ? SA_RESTART | SA_RESETHAND : SA_RESTART);
        sigemptyset(&action.sa_mask);
        sigaction(numbers[i], &action, NULL);
    }
}

int stop_is_asked(void)
{
    return signal_that_came != 0;
}

int stop_report(void)
{
    if (signal_that_came == SIGINT) {
        message("interrupted");
        return EXIT_CODE_INTERRUPTED;
    }
    message("stopped; run the same command again");
    return EXIT_CODE_STOPPED;
}
