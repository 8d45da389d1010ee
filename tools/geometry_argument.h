/* Geometry of an image that its metadata lack: options that verbs share which work on image files.
 */
#ifndef SONJECT_TOOLS_GEOMETRY_ARGUMENT_H
#define SONJECT_TOOLS_GEOMETRY_ARGUMENT_H

#include <sonject/sonject.h>

#include "arguments.h"

struct geometry_arguments {
    const char *range_axis;
    struct number_argument altitude;
    struct number_argument row_spacing;
    struct number_argument column_spacing;
    struct number_argument first_range;
};

/* Lines of a verb's arguments, whose options are a structure with a struct geometry_arguments
 * `geometry`. axis: what the verb does with the range axis. */
#define GEOMETRY_ARGUMENTS(structure, axis)                                                        \
    {"--range-axis",                                                                               \
     NULL,                                                                                         \
     "slant|ground",                                                                               \
     axis,                                                                                         \
     ARGUMENT_TEXT,                                                                                \
     false,                                                                                        \
     offsetof(structure, geometry.range_axis)},                                                    \
        {"--altitude",                                                                             \
         NULL,                                                                                     \
         "M",                                                                                      \
         "height of the sonar over the seabed",                                                    \
         ARGUMENT_NUMBER,                                                                          \
         false,                                                                                    \
         offsetof(structure, geometry.altitude)},                                                  \
        {"--row-spacing",                                                                          \
         NULL,                                                                                     \
         "M",                                                                                      \
         "along-track distance of rows",                                                           \
         ARGUMENT_NUMBER,                                                                          \
         false,                                                                                    \
         offsetof(structure, geometry.row_spacing)},                                               \
        {"--column-spacing",                                                                       \
         NULL,                                                                                     \
         "M",                                                                                      \
         "slant range distance of columns",                                                        \
         ARGUMENT_NUMBER,                                                                          \
         false,                                                                                    \
         offsetof(structure, geometry.column_spacing)},                                            \
    {                                                                                              \
        "--first-range", NULL, "M", "slant range of the first column", ARGUMENT_NUMBER, false,     \
            offsetof(structure, geometry.first_range)                                              \
    }

/* Fills what was given: *is_ground 0 or 1, *altitude_m, and the geometry with *has_geometry 1; the
 * rest stays. false after a message that begins with the verb's name. */
bool geometry_parse(const char *verb, const struct geometry_arguments *arguments,
                    uint32_t *is_ground, double *altitude_m, uint32_t *has_geometry,
                    sonject_geometry_params *geometry);

#endif
