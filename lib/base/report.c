#include "base/report.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"

/* Messages may be kept in files, so they do not follow the host's locale. */
static void format_line(char line[REPORT_LINE], const char *format, va_list arguments)
{
    vsnprintf(line, REPORT_LINE, format, arguments);
    text_use_points(line);
    text_make_printable(line);
}

sonject_status report_failure(struct report *report, sonject_status status, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    format_line(report->message, format, arguments);
    va_end(arguments);
    return status;
}

sonject_status report_gather(struct report *report, char lines[REPORT_CAPACITY],
                             sonject_status so_far, sonject_status step)
{
    static const char rest[] = "and more";
    const size_t length = strlen(lines);
    const size_t room = REPORT_CAPACITY - length;
    if (step == SONJECT_OK)
        return so_far;
    if (step == SONJECT_ERROR_INPUT) {
        const bool fits = strlen(report->message) + sizeof rest + 2 < room;
        if (fits || length < strlen(rest) || strcmp(lines + length - strlen(rest), rest) != 0)
            snprintf(lines + length, room, "%s%s", length > 0 ? "\n" : "",
                     fits ? report->message : rest);
        strcpy(report->message, lines);
    }
    return step;
}

sonject_status report_out_of_memory(struct report *report, const char *what)
{
    return report_failure(report, SONJECT_ERROR_MEMORY, "out of memory for %s", what);
}

bool report_is_cancelled(const struct report *report, const char *stage)
{
    const struct report_host *host = report->host;
    return host && host->progress &&
           host->progress(host->progress_user, host->fraction, stage ? stage : host->stage) != 0;
}

int progress_share_tell(void *user, double fraction, const char *stage)
{
    const struct progress_share *part = user;
    return part->progress ? part->progress(part->user, part->first + part->share * fraction, stage)
                          : 0;
}

void report_line(struct report *report, uint32_t level, const char *line)
{
    if (report->log)
        report->log(report->host ? report->host->log_user : NULL, level, line);
}

static void report_formatted(struct report *report, uint32_t level, const char *format,
                             va_list arguments)
{
    char line[REPORT_LINE];
    format_line(line, format, arguments);
    report_line(report, level, line);
}

void report_log(struct report *report, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    report_formatted(report, SONJECT_LOG_NEWS, format, arguments);
    va_end(arguments);
}

void report_note(struct report *report, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    report_formatted(report, SONJECT_LOG_NOTE, format, arguments);
    va_end(arguments);
}

static void fail(struct check *check, const char *key, const char *others, const char *format,
                 va_list arguments)
{
    char what[400];
    vsnprintf(what, sizeof what, format, arguments);
    if (check->status == SONJECT_OK && check->report)
        report_failure(check->report, SONJECT_ERROR_INPUT, "%s %s", key, what);
    if (check->listener)
        check->listener->hear(check->listener, key, others, what);
    check->status = SONJECT_ERROR_INPUT;
}

void check_relation(struct check *check, const char *key, const char *others, const char *format,
                    ...)
{
    va_list arguments;
    va_start(arguments, format);
    fail(check, key, others, format, arguments);
    va_end(arguments);
}

/* Asks for values in range, never for violations, because NaN fails every comparison. */
void check_within(struct check *check, const char *key, double value, double minimum,
                  double maximum, const char *unit)
{
    if (!(value >= minimum && value <= maximum))
        check_relation(check, key, "", "must be %g...%g%s, not %g", minimum, maximum, unit, value);
}

void check_positive_length(struct check *check, const char *key, double value_m)
{
    check_within(check, key, value_m, LENGTH_MIN_M, LENGTH_MAX_M, " m");
}

void check_length(struct check *check, const char *key, double value_m)
{
    check_within(check, key, value_m, 0.0, LENGTH_MAX_M, " m");
}

void check_coordinate(struct check *check, const char *key, double value_m)
{
    check_within(check, key, value_m, -LENGTH_MAX_M, LENGTH_MAX_M, " m");
}

const char *sonject_version(void)
{
    return VERSION_TEXT;
}
