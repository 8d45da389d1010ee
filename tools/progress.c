#define _POSIX_C_SOURCE 200809L

#include "progress.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "message.h"
#include "stop.h"

enum {
    LINE_WIDTH = 78,
    STAGE_WIDTH = 28, /* "hearing the impulses" fits */
    BAR_WIDTH = 19
};

static const double redraw_interval_s = 0.1;

static double now_s(void)
{
    struct timespec now;
    if (clock_gettime(CLOCK_MONOTONIC, &now) != 0)
        return 0;
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void progress_begin(struct progress *progress, bool is_quiet)
{
    progress->is_shown = !is_quiet && isatty(STDERR_FILENO);
    progress->is_on_screen = false;
    progress->start_s = now_s();
    progress->drawn_s = -redraw_interval_s;
}

/* Time that the rest will take if it goes on as so far. */
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
    format_time_left(left, sizeof(left), now_s() - progress->start_s, fraction);
    fprintf(stderr, "\r%-*.*s [%s] %3d %%  %-20s", STAGE_WIDTH, STAGE_WIDTH, stage, bar,
            (int)(fraction * 100), left);
    fflush(stderr);
    progress->is_on_screen = true;
}

int progress_update(void *user, double fraction, const char *stage)
{
    struct progress *progress = user;
    double now = now_s();
    if (progress->is_shown && now - progress->drawn_s >= redraw_interval_s) {
        double within = fraction > 0 ? (fraction < 1 ? fraction : 1) : 0;
        draw(progress, within, stage ? stage : "");
        progress->drawn_s = now;
    }
    return stop_is_asked();
}

void progress_log(void *user, const char *line)
{
    progress_end(user);
    message(line);
}

void progress_end(struct progress *progress)
{
    if (progress->is_on_screen) {
        fprintf(stderr, "\r%*s\r", LINE_WIDTH, "");
        fflush(stderr);
        progress->is_on_screen = false;
    }
}
