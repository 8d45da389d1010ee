#include "base/report.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"

sonject_status report_failure(struct report *report, sonject_status status, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(report->message, REPORT_LINE, format, arguments);
    va_end(arguments);
    text_make_printable(report->message);
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

bool report_is_cancelled(const struct report *report)
{
    const struct report_host *host = report->host;
    return host && host->progress &&
           host->progress(host->progress_user, host->fraction, host->stage) != 0;
}

void report_news(struct report *report, const char *format, ...)
{
    if (!report->log)
        return;
    char line[REPORT_LINE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    text_make_printable(line);
    report->log(report->host ? report->host->log_user : NULL, line);
}
