#include "api/geometry_notes.h"

#include <stdio.h>
#include <string.h>

#include "base/text.h"

static void note(struct geometry_notes *notes, size_t index, const char *name, double value)
{
    snprintf(notes->texts[index], sizeof notes->texts[index], "%.9g", value);
    /* a host may run under a locale that writes commas */
    char *comma = strchr(notes->texts[index], ',');
    if (comma)
        *comma = '.';
    notes->attributes[index].name = name;
    notes->attributes[index].value = notes->texts[index];
}

void geometry_notes_init(struct geometry_notes *notes, const sonject_sonar_params *sonar,
                         const sonject_geometry_params *geometry, double first_row,
                         double first_column)
{
    note(notes, 0, "sonject:frequency_hz", sonar->centre_frequency_hz);
    note(notes, 1, "sonject:bandwidth_hz", sonar->bandwidth_hz);
    note(notes, 2, "sonject:altitude_m", sonar->altitude_m);
    note(notes, 3, "sonject:row_spacing_m", geometry->row_spacing_m);
    note(notes, 4, "sonject:column_spacing_m", geometry->column_spacing_m);
    note(notes, 5, "sonject:first_along_track_m",
         geometry->first_along_track_m + first_row * geometry->row_spacing_m);
    note(notes, 6, "sonject:first_slant_range_m",
         geometry->first_slant_range_m + first_column * geometry->column_spacing_m);
    notes->attributes[7].name = "sonject:side";
    notes->attributes[7].value = geometry->side == SONJECT_SIDE_STARBOARD ? "starboard" : "port";
    notes->attributes[8].name = "sonject:range_axis";
    notes->attributes[8].value = "slant";
}

static bool read_number(const struct swath_file *file, const char *name, double *value)
{
    char text[64];
    const char *rest;
    return swath_file_attribute(file, name, text, sizeof text) &&
           text_to_number(text, value, &rest) && *rest == '\0';
}

bool geometry_notes_read(const struct swath_file *file, sonject_geometry_params *geometry,
                         double *altitude_m)
{
    sonject_geometry_params read = *geometry;
    double altitude;
    char side[16];
    if (!read_number(file, "sonject:row_spacing_m", &read.row_spacing_m) ||
        !read_number(file, "sonject:column_spacing_m", &read.column_spacing_m) ||
        !read_number(file, "sonject:first_along_track_m", &read.first_along_track_m) ||
        !read_number(file, "sonject:first_slant_range_m", &read.first_slant_range_m) ||
        !read_number(file, "sonject:altitude_m", &altitude) ||
        !swath_file_attribute(file, "sonject:side", side, sizeof side))
        return false;
    read.side = strcmp(side, "starboard") == 0 ? SONJECT_SIDE_STARBOARD : SONJECT_SIDE_PORT;
    *geometry = read;
    *altitude_m = altitude;
    return true;
}
