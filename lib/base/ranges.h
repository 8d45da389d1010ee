/* How the checks of a scene say that a value is out of range. */
#ifndef SONJECT_BASE_RANGES_H
#define SONJECT_BASE_RANGES_H

#include <stdint.h>

#include "base/report.h"

/* Of lengths that a sonar can meet. */
#define LENGTH_MIN_M 1e-6
#define LENGTH_MAX_M 1e6

/* Is told of every failure of a check, for what is to tell them all. Keys are the names of values
 * as scene files write them, borrowed. others: keys, separated by blanks, without whose
 * being right the failure says nothing. */
struct check_listener {
    void (*hear)(struct check_listener *listener, const char *key, const char *others,
                 const char *what);
};

/* A check that goes on. The report keeps the first failure. Either may be NULL. */
struct check {
    struct report *report;
    struct check_listener *listener;
    sonject_status status;
};

/* The message "<key> <what>"; check->status becomes INPUT. */
void check_failure(struct check *check, const char *key, const char *format, ...) REPORT_FORMAT(3);

/* The same where the value is wrong only beside those of others. */
void check_relation(struct check *check, const char *key, const char *others, const char *format,
                    ...) REPORT_FORMAT(4);

/* unit: as it stands behind a number, " m"; "" for none. */
void check_within(struct check *check, const char *key, double value, double minimum,
                  double maximum, const char *unit);
void check_finite(struct check *check, const char *key, double value);

/* Choices are numbered from 0. */
void check_choice(struct check *check, const char *key, uint32_t value, uint32_t count);

/* Lengths in m: above 0, from 0, and of any sign. */
void check_positive_length(struct check *check, const char *key, double value_m);
void check_length(struct check *check, const char *key, double value_m);
void check_coordinate(struct check *check, const char *key, double value_m);

#endif
