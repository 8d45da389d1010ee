/* Tables of numbers as text, such as CSV files, and sound-speed profiles. */
#ifndef SONJECT_SCHEMA_TABLES_H
#define SONJECT_SCHEMA_TABLES_H

#include <stdbool.h>
#include <stddef.h>

#include "base/report.h"
#include "medium/water.h"

#define TABLE_FIELDS_MAX    64
#define TABLE_FILE_CAPACITY 400

/* A line of a table that is neither empty nor a comment. Fields are ended by 0, have no blanks
 * around them, and lie in the line, which is gone after the call. */
struct table_row {
    size_t line;    /* line of the file, from 1 */
    bool has_names; /* the first row, which names the columns; all others have as many fields */
    const char *start;
    char *const *fields;
    size_t count; /* at most TABLE_FIELDS_MAX */
};

typedef sonject_status table_row_function(void *user, const struct table_row *row);

/* Reads a text file row by row, while take returns OK. separators: the first of these that the
 * first row has separates all fields. A blank stands for any white space. Without a separator a row
 * is one field. Fields may be in quotes, as spreadsheets write them, unless blanks separate them.
 * The text after a # outside of quotes is a comment. Errors: STORAGE, INPUT, MEMORY, or the status
 * that take returned. */
sonject_status table_rows_read(struct report *report, const char *path, size_t bytes_max,
                               const char *separators, table_row_function *take, void *user);

/* Reports "file:line: column: what" and returns INPUT. column "": the row as a whole. */
sonject_status table_refuse(struct report *report, const char *file, size_t line,
                            const char *column, const char *format, ...) REPORT_FORMAT(5);

#define TABLE_COLUMNS_MAX 4

/* The columns that a table is read for, by name: one of the first two (the second may be NULL), the
 * third, and the fourth if it is there. */
struct table_format {
    const char *names[TABLE_COLUMNS_MAX]; /* NULL for names that are not used */
    size_t samples_max, bytes_max;
    /* Bounds for all samples: their least number, the largest magnitude in each column (0: any),
     * and whether the positions must rise. */
    size_t samples_min;
    double most[TABLE_COLUMNS_MAX];
    bool rises;
};

#define ARRAY_VALUES_MAX ((size_t)1 << 24)

/* An array in memory that stands in for a file. */
struct number_array {
    char *name;     /* for messages */
    char *columns;  /* names of the columns, separated as in a file's first line; NULL: none */
    double *values; /* rows x column_count */
    size_t rows, column_count;
};

/* A table of numbers. Samples are in the order in which they were written. */
struct number_table {
    const struct table_format *format; /* borrowed */
    double *values[TABLE_COLUMNS_MAX]; /* owned; NULL: the file has no such column */
    size_t *lines;                     /* line of each sample; owned */
    size_t count;
    size_t last_line;
    char file[TABLE_FILE_CAPACITY]; /* for messages */
};

/* Reads a table from a file or, if it is not NULL, from array, whose rows are counted from 1 in
 * messages. A file has a line of column names, then one line per sample. Semicolons, or else
 * commas, or else white space separate columns, as in the first line. The text after a # is a
 * comment. Other columns are ignored. format: borrowed. On success the table is the caller's for
 * number_table_clear. Message: "file:line: column: what". Errors: STORAGE, INPUT, MEMORY. */
sonject_status number_table_read(struct report *report, const char *path,
                                 const struct number_array *array,
                                 const struct table_format *format, struct number_table *table);

/* Reports a message about a sample's value, returns INPUT. sample: count for the whole table. */
sonject_status number_table_refuse(const struct number_table *table, struct report *report,
                                   size_t sample, size_t column, const char *what);

void number_table_clear(struct number_table *table);

/* ---- Sound-speed profiles, such as a cast's. */

#define PROFILE_SAMPLES_MAX WATER_LAYERS_MAX /* more samples would give more layers */
#define PROFILE_BYTES_MAX   (1024 * 1024)

/* A profile. Samples are in the order in which they were written, upwards or downwards. */
struct profile_table {
    double *positions_m; /* heights over the mean seabed, or depths below the sea surface; owned */
    double *speeds_mps;  /* owned */
    size_t count;
    bool is_depth;
};

/* The reason why a sample cannot be used. */
struct profile_fault {
    size_t sample;
    bool is_speed; /* the speed is wrong, not the position */
    char what[200];
};

/* Reads a table with the columns height_m or depth_m, and sound_speed_mps, and checks all samples.
 * table: zeroed; on success the caller's for profile_table_clear. Errors and message: as for
 * number_table_read. */
sonject_status profile_table_read(struct report *report, const char *path,
                                  const struct number_array *array, struct profile_table *table);

/* Returns whether there are at least two samples, positions rise or fall all the way, and all
 * numbers are within their ranges. If not, fault gets the first wrong sample. */
bool profile_table_is_good(const struct profile_table *table, struct profile_fault *fault);

/* Turns a good table into heights that rise. Depths are subtracted from the water's, depth_m. */
void profile_table_to_heights(struct profile_table *table, double depth_m);

void profile_table_clear(struct profile_table *table);

#endif
