#include "base/ranges.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

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

void check_failure(struct check *check, const char *key, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fail(check, key, "", format, arguments);
    va_end(arguments);
}

void check_relation(struct check *check, const char *key, const char *others, const char *format,
                    ...)
{
    va_list arguments;
    va_start(arguments, format);
    fail(check, key, others, format, arguments);
    va_end(arguments);
}

/* NaN fails every comparison, so ranges are asked for, never violations. */
void check_within(struct check *check, const char *key, double value, double minimum,
                  double maximum, const char *unit)
{
    if (!(value >= minimum && value <= maximum))
        check_failure(check, key, "must be %g...%g%s, not %g", minimum, maximum, unit, value);
}

void check_finite(struct check *check, const char *key, double value)
{
    if (!isfinite(value))
        check_failure(check, key, "must be a finite number, not %g", value);
}

void check_choice(struct check *check, const char *key, uint32_t value, uint32_t count)
{
    if (value >= count)
        check_failure(check, key, "has no choice number %lu; the last is %lu", (unsigned long)value,
                      (unsigned long)count - 1);
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
