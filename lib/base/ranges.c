#include "base/ranges.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#define LENGTH_MIN_M 1e-6
#define LENGTH_MAX_M 1e6

void check_failure(struct check *check, const char *key, const char *format, ...)
{
    char what[400];
    va_list arguments;
    if (check->status != SONJECT_OK)
        return;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    if (check->key)
        *check->key = key;
    check->status = report_failure(check->report, SONJECT_ERROR_INPUT, "%s %s", key, what);
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
