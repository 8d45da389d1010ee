/* Options about image files: geometry that their metadata lack, a transfer function, a channel.
 * They become texts as in a scene's section input. */
#ifndef SONJECT_TOOLS_IMAGE_ARGUMENTS_H
#define SONJECT_TOOLS_IMAGE_ARGUMENTS_H

#include <sonject/sonject.h>

#include "arguments.h"

#define IMAGE_TEXT 200 /* capacity of such a text, bytes */

struct geometry_arguments {
    const char *range_axis;
    struct number_argument altitude;
    struct number_argument row_spacing;
    struct number_argument column_spacing;
    struct number_argument first_range;
};

/* Rows of a verb's arguments; the structure of its options has a struct geometry_arguments
 * `geometry`. axis: help for the range axis. */
#define GEOMETRY_NUMBER(structure, name, unit, help, member)                                       \
    {                                                                                              \
        name, NULL, unit, help, ARGUMENT_NUMBER, false, offsetof(structure, geometry.member)       \
    }
#define GEOMETRY_ARGUMENTS(structure, axis)                                                        \
    {"--range-axis",                                                                               \
     NULL,                                                                                         \
     "slant|ground",                                                                               \
     axis,                                                                                         \
     ARGUMENT_TEXT,                                                                                \
     false,                                                                                        \
     offsetof(structure, geometry.range_axis)},                                                    \
        GEOMETRY_NUMBER(structure, "--altitude", "M", "height of the sonar over the seabed",       \
                        altitude),                                                                 \
        GEOMETRY_NUMBER(structure, "--row-spacing", "M", "distance between rows, along the track", \
                        row_spacing),                                                              \
        GEOMETRY_NUMBER(structure, "--column-spacing", "M",                                        \
                        "distance between columns, in slant range", column_spacing),               \
        GEOMETRY_NUMBER(structure, "--first-range", "M", "slant range of the first column",        \
                        first_range)

#define TRANSFER_NOTES                                                                             \
    "Transfer functions: amplitude, intensity, decibel:DB_PER_UNIT[:OFFSET_DB], gamma:EXPONENT,\n" \
    "schlick:B."

/* Sets what was given: *is_ground to 0 or 1, *altitude_m, and *geometry to text; the rest stays.
 * Returns false after a message that begins with the verb's name, as the next functions do. */
bool geometry_parse(const char *verb, const struct geometry_arguments *arguments,
                    uint32_t *is_ground, double *altitude_m, char text[IMAGE_TEXT],
                    const char **geometry);

/* Parses --transfer KIND[:P[:OFFSET]]. NULL: not given, *transfer stays. */
bool transfer_parse(const char *verb, const char *argument, char text[IMAGE_TEXT],
                    const char **transfer);

/* Checks --channel: port, starboard or a number; NULL: not given. */
bool channel_check(const char *verb, const char *argument);

/* Parses --db MIN:MAX; NULL: not given, the values stay. */
bool decibels_parse(const char *verb, const char *argument, double *minimum_db, double *maximum_db);

#endif
