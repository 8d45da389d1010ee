/* Sound-speed profiles as tables of text, such as a cast's CSV file. */
#ifndef SONJECT_SCHEMA_PROFILE_TABLE_H
#define SONJECT_SCHEMA_PROFILE_TABLE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/report.h"
#include "medium/water.h"
#include "schema/number_table.h"

#define PROFILE_SAMPLES_MAX WATER_LAYERS_MAX /* more of them give more layers */
#define PROFILE_BYTES_MAX   (1024 * 1024)

/* Samples in the order in which they were written, upwards or downwards. */
struct profile_table {
    double *positions_m; /* heights over the mean seabed, or depths below the sea surface; owned */
    double *speeds_mps;  /* owned */
    size_t count;
    bool is_depth;
};

/* Why a sample cannot be used. */
struct profile_fault {
    size_t sample;
    bool is_speed; /* not its position */
    char what[200];
};

/* Reads a file: a line of column names, among them height_m or depth_m, and sound_speed_mps; then
 * one line a sample. Columns are separated by semicolons, or else commas, or else white space, as
 * the first line has them; what follows a # is a comment; other columns are passed over. All
 * samples are checked. table: zeroed; on success the caller's for profile_table_clear. Message:
 * "file:line: column: what". Errors: STORAGE, INPUT, MEMORY. */
sonject_status profile_table_read(struct report *report, const char *path,
                                  struct profile_table *table);

/* The same of an array. */
sonject_status profile_table_take(struct report *report, const struct number_array *array,
                                  struct profile_table *table);

/* Whether there are at least two samples, positions rise or fall all the way, and all numbers are
 * within their ranges; if not, fault gets the first sample that is wrong. */
bool profile_table_is_good(const struct profile_table *table, struct profile_fault *fault);

/* Turns a good table into heights that rise; depth_m: of the water, over which a table of depths
 * ends. */
void profile_table_to_heights(struct profile_table *table, double depth_m);

void profile_table_clear(struct profile_table *table);

#endif
