/* The message of the last failure, the log, and checks of values. Every function that can fail
 * takes a report. */
#ifndef SONJECT_BASE_REPORT_H
#define SONJECT_BASE_REPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <sonject/context.h>
#include <sonject/status.h>
#include <sonject/version.h>

/* The library's version, as sonject_version gives it. */
#define TEXT_OF_(token) #token
#define TEXT_OF(token)  TEXT_OF_(token)
#define VERSION_TEXT                                                                               \
    TEXT_OF(SONJECT_VERSION_MAJOR)                                                                 \
    "." TEXT_OF(SONJECT_VERSION_MINOR) "." TEXT_OF(SONJECT_VERSION_PATCH)

#define REPORT_LINE     1024 /* bytes of a line */
#define REPORT_CAPACITY 8192
#define INPUTS_KEPT     64 /* images that a call remembers to have read */

struct decoder;
struct read_files;

/* Data that a context lends to all its calls. */
struct report_host {
    void *log_user;
    struct decoder *decoder; /* the reader of images and HDF5 files (swath/decoder.h) */
    /* The running call's progress function (may be NULL) and what it was last told. */
    sonject_progress_function progress;
    void *progress_user;
    double fraction;
    char stage[64];
};

struct report {
    char message[REPORT_CAPACITY];  /* "" if nothing failed; one line, or a line for each mistake */
    sonject_log_function log;       /* may be NULL */
    const struct report_host *host; /* NULL: no progress, and a decoder for each file */
    /* Images that the call has read. file_publish does not replace them (file_protect). */
    struct {
        uint64_t device, number;
    } inputs[INPUTS_KEPT];
    size_t input_count;
    struct read_files *reads; /* gets the files that a call reads (file_note_read); NULL: none */
};

#if defined(__GNUC__)
#define REPORT_FORMAT(format_index) __attribute__((format(printf, format_index, format_index + 1)))
#else
#define REPORT_FORMAT(format_index)
#endif

/* Keeps the message, as text_make_printable leaves it, and returns status, so that a caller can
 * write: return report_failure(report, SONJECT_ERROR_INPUT, "..."). */
sonject_status report_failure(struct report *report, sonject_status status, const char *format, ...)
    REPORT_FORMAT(3);

/* Reports an allocation that failed. Returns SONJECT_ERROR_MEMORY. what: such as "histogram". */
sonject_status report_out_of_memory(struct report *report, const char *what);

/* Returns the status so far of steps that are all taken even if one finds bad input; starts as
 * SONJECT_OK. A step's message is added to lines, which start as "" and become the report's
 * message. "and more" replaces messages without room. No step may follow a status but OK and
 * INPUT. */
sonject_status report_gather(struct report *report, char lines[REPORT_CAPACITY],
                             sonject_status so_far, sonject_status step);

/* Returns from the function if expression, a sonject_status, is a failure. */
#define CHECK(expression)                                                                          \
    do {                                                                                           \
        const sonject_status checked_status = (expression);                                        \
        if (checked_status != SONJECT_OK)                                                          \
            return checked_status;                                                                 \
    } while (0)

/* Returns from the function if memory is not there. what: see report_out_of_memory. */
#define CHECK_MEMORY(report, is_there, what)                                                       \
    do {                                                                                           \
        if (!(is_there))                                                                           \
            return report_out_of_memory(report, what);                                             \
    } while (0)

/* Takes the next step of a function that releases something at its end, if status, a variable, is
 * SONJECT_OK. status becomes the step's. */
#define THEN(status, expression)                                                                   \
    do {                                                                                           \
        if ((status) == SONJECT_OK)                                                                \
            (status) = (expression);                                                               \
    } while (0)

/* Returns whether the caller wants to end the running call; asked during waits. stage: the wait's
 * purpose; NULL: the stage that was told last. */
bool report_is_cancelled(const struct report *report, const char *stage);

/* ---- Progress of a part of a call as a share of the whole call's. */

/* A part of a call's progress: the part's fractions 0...1 become first...first + share. */
struct progress_share {
    sonject_progress_function progress; /* the whole call's; may be NULL */
    void *user;
    double first, share;
};

/* A sonject_progress_function; user: the struct progress_share. */
int progress_share_tell(void *user, double fraction, const char *stage);

/* ---- The log. */

/* Sends a line to the log, if there is one: news, a note, or a line of a given level. */
void report_log(struct report *report, const char *format, ...) REPORT_FORMAT(2);
void report_note(struct report *report, const char *format, ...) REPORT_FORMAT(2);
void report_line(struct report *report, uint32_t level, const char *line);

/* The range of lengths that a sonar can meet. */
#define LENGTH_MIN_M 1e-6
#define LENGTH_MAX_M 1e6

/* A listener that hears every failure of a check, to report all of them. Keys are the names of
 * values in scene files, borrowed. others: keys, separated by blanks, whose values must be right
 * for the failure to mean anything. */
struct check_listener {
    void (*hear)(struct check_listener *listener, const char *key, const char *others,
                 const char *what);
};

/* A check of several values. report keeps the first failure. report and listener may be NULL. */
struct check {
    struct report *report;
    struct check_listener *listener;
    sonject_status status;
};

/* Reports "<key> <what>"; check->status becomes INPUT. others: see check_listener; "": none. */
void check_relation(struct check *check, const char *key, const char *others, const char *format,
                    ...) REPORT_FORMAT(4);

/* Checks a range. unit: the text behind a number, such as " m"; "" for none. */
void check_within(struct check *check, const char *key, double value, double minimum,
                  double maximum, const char *unit);

/* Checks a length in m: above 0, from 0, or of any sign. */
void check_positive_length(struct check *check, const char *key, double value_m);
void check_length(struct check *check, const char *key, double value_m);
void check_coordinate(struct check *check, const char *key, double value_m);

#endif
