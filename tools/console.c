#include "console.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/system/process.h"
#include "base/text.h"

enum {
    LINE_WIDTH = 78,
    STAGE_WIDTH = 28, /* room for "hearing the impulses" */
    BAR_WIDTH = 19
};

static const double redraw_interval_s = 0.1;

void message_line(const char *const *texts)
{
    fputs("sonject: ", stderr);
    for (; *texts; texts++) {
        char *shown = malloc(strlen(*texts) + 1);
        if (!shown)
            continue;
        text_make_printable(strcpy(shown, *texts));
        fputs(shown, stderr);
        free(shown);
    }
    fputc('\n', stderr);
}

int exit_code_of(sonject_status status)
{
    switch (status) {
    case SONJECT_OK:
        return EXIT_CODE_DONE;
    case SONJECT_ERROR_ARGUMENT:
        return EXIT_CODE_USAGE;
    case SONJECT_ERROR_INPUT:
    case SONJECT_ERROR_UNSUPPORTED:
        return EXIT_CODE_INPUT;
    case SONJECT_ERROR_DEVICE:
        return EXIT_CODE_DEVICE;
    case SONJECT_ERROR_STORAGE:
    case SONJECT_ERROR_MEMORY:
        return EXIT_CODE_STORAGE;
    case SONJECT_CANCELLED:
        return EXIT_CODE_STOPPED;
    }
    return EXIT_CODE_STORAGE;
}

int fail_with(const sonject_context *context, sonject_status status)
{
    const char *text = context ? sonject_context_message(context) : "";
    if (!text[0])
        message(sonject_status_name(status));
    while (*text) { /* one line for each mistake in a scene */
        char line[2048];
        const size_t length = strcspn(text, "\n");
        snprintf(line, sizeof line, "%.*s", (int)length, text);
        message(line);
        text += length + (text[length] == '\n');
    }
    return exit_code_of(status);
}

int finish_output(void)
{
    int had_failed = ferror(stdout);
    errno = 0;
    if (fflush(stdout) == 0 && !had_failed)
        return EXIT_CODE_DONE;
    message("cannot write to the standard output: ", errno ? strerror(errno) : "write error");
    return EXIT_CODE_STORAGE;
}

static volatile sig_atomic_t signal_that_came;

static void note_signal(int number)
{
    signal_that_came = number;
}

void stop_watch(void)
{
    signals_watch(note_signal);
}

int stop_is_asked(void)
{
    /* LLVM, which OpenCL drivers load, puts its handlers in place of these. The first signal undoes
     * them, and a second one in that moment would end the command. */
    if (!signal_that_came)
        stop_watch();
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

void progress_begin(struct progress *progress, bool is_quiet)
{
    progress->is_shown = !is_quiet && errors_are_shown();
    progress->is_on_screen = false;
    progress->start_s = clock_seconds();
    progress->drawn_s = -redraw_interval_s;
}

/* Formats the time left at the speed so far. */
static void format_time_left(char *text, size_t capacity, double elapsed_s, double fraction)
{
    double left_s = elapsed_s * (1 - fraction) / fraction;
    text[0] = '\0';
    if (fraction < 0.01 || !(left_s < 360000))
        return; /* too early to tell */
    unsigned seconds = (unsigned)ceil(left_s);
    if (seconds >= 3600)
        snprintf(text, capacity, "%u h %02u min left", seconds / 3600, seconds / 60 % 60);
    else if (seconds >= 60)
        snprintf(text, capacity, "%u min %02u s left", seconds / 60, seconds % 60);
    else
        snprintf(text, capacity, "%u s left", seconds);
}

static void draw(struct progress *progress, double fraction, const char *stage)
{
    char bar[BAR_WIDTH + 1];
    size_t filled = (size_t)(fraction * BAR_WIDTH);
    memset(bar, '#', filled);
    memset(bar + filled, '.', BAR_WIDTH - filled);
    bar[BAR_WIDTH] = '\0';
    char left[40];
    format_time_left(left, sizeof(left), clock_seconds() - progress->start_s, fraction);
    fprintf(stderr, "\r%-*.*s [%s] %3d %%  %-20s", STAGE_WIDTH, STAGE_WIDTH, stage, bar,
            (int)(fraction * 100), left);
    fflush(stderr);
    progress->is_on_screen = true;
}

int progress_update(void *user, double fraction, const char *stage)
{
    struct progress *progress = user;
    double now = clock_seconds();
    if (progress->is_shown && now - progress->drawn_s >= redraw_interval_s) {
        double within = fraction > 0 ? (fraction < 1 ? fraction : 1) : 0;
        draw(progress, within, stage ? stage : "");
        progress->drawn_s = now;
    }
    return stop_is_asked();
}

void progress_log(void *user, uint32_t level, const char *line)
{
    if (user)
        progress_end(user);
    message(level == SONJECT_LOG_NOTE ? "note: " : "", line);
}

void progress_note(void *user, uint32_t level, const char *line)
{
    if (level == SONJECT_LOG_NOTE)
        progress_log(user, level, line);
}

void progress_end(struct progress *progress)
{
    if (progress->is_on_screen) {
        fprintf(stderr, "\r%*s\r", LINE_WIDTH, "");
        fflush(stderr);
        progress->is_on_screen = false;
    }
}
