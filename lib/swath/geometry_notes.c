#include "swath/geometry_notes.h"

#include <math.h>
#include <string.h>

#include "base/text.h"
#include "scene/scene.h"

#define DIGITS 9

static void note_text(struct geometry_notes *notes, const char *name, const char *text)
{
    notes->attributes[notes->count].name = name;
    notes->attributes[notes->count++].value = text;
}

static void note_number(struct geometry_notes *notes, const char *name, double number)
{
    char *text = notes->texts[notes->count];
    if (isfinite(number))
        note_text(notes, name, text_of_number(text, sizeof notes->texts[0], number, DIGITS));
}

void geometry_notes_make(struct geometry_notes *notes, const struct noted_geometry *geometry)
{
    const bool is_ground = geometry->axis == RANGE_GROUND;
    memset(notes, 0, sizeof *notes);
    note_number(notes, "sonject:frequency_hz", geometry->frequency_hz);
    note_number(notes, "sonject:bandwidth_hz", geometry->bandwidth_hz);
    note_number(notes, "sonject:altitude_m", geometry->altitude_m);
    note_number(notes, "sonject:row_spacing_m", geometry->row_spacing_m);
    note_number(notes, "sonject:column_spacing_m", geometry->column_spacing_m);
    note_number(notes, "sonject:first_along_track_m", geometry->first_along_track_m);
    note_number(notes, is_ground ? "sonject:first_ground_range_m" : "sonject:first_slant_range_m",
                geometry->first_range_m);
    if (geometry->knows_side)
        note_text(notes, "sonject:side",
                  geometry->side == SONJECT_SIDE_STARBOARD ? "starboard" : "port");
    if (geometry->axis != RANGE_UNKNOWN)
        note_text(notes, "sonject:range_axis", is_ground ? "ground" : "slant");
}

void geometry_notes_init(struct geometry_notes *notes, const sonject_sonar_params *sonar,
                         const sonject_geometry_params *geometry, double first_row,
                         double first_column)
{
    const struct noted_geometry noted = {
        .axis = RANGE_SLANT,
        .row_spacing_m = geometry->row_spacing_m,
        .column_spacing_m = geometry->column_spacing_m,
        .first_along_track_m = geometry->first_along_track_m + first_row * geometry->row_spacing_m,
        .first_range_m = geometry->first_slant_range_m + first_column * geometry->column_spacing_m,
        .altitude_m = sonar->altitude_m,
        .frequency_hz = sonar->centre_frequency_hz,
        .bandwidth_hz = sonar->bandwidth_hz,
        .knows_side = true,
        .side = geometry->side,
    };
    geometry_notes_make(notes, &noted);
}

/* NaN where the file does not say it. */
static double noted_number(const struct swath_file *file, const char *name)
{
    char text[64];
    const char *rest;
    double value;
    return swath_file_attribute(file, name, text, sizeof text) &&
                   text_to_number(text, &value, &rest) && *rest == '\0' && isfinite(value)
               ? value
               : NAN;
}

static void read_recording(const struct xtf_file *xtf, struct noted_geometry *geometry)
{
    const struct xtf_geometry told = xtf_geometry_of(xtf, 0, xtf->rows);
    geometry->row_spacing_m = told.row_spacing_m > 0.0 ? told.row_spacing_m : NAN;
    geometry->column_spacing_m = told.column_spacing_m;
    geometry->first_along_track_m = 0.0;
    geometry->first_range_m = told.first_slant_range_m;
    geometry->altitude_m = told.altitude_m > 0.0 ? told.altitude_m : NAN;
    geometry->frequency_hz = geometry->bandwidth_hz = NAN;
    geometry->knows_side = true;
    geometry->side = xtf->side == XTF_PORT ? SONJECT_SIDE_PORT : SONJECT_SIDE_STARBOARD;
}

static void read_texts(const struct swath_file *file, struct noted_geometry *geometry)
{
    char side[16] = "";
    geometry->row_spacing_m = noted_number(file, "sonject:row_spacing_m");
    geometry->column_spacing_m = noted_number(file, "sonject:column_spacing_m");
    geometry->first_along_track_m = noted_number(file, "sonject:first_along_track_m");
    geometry->first_range_m =
        noted_number(file, geometry->axis == RANGE_GROUND ? "sonject:first_ground_range_m"
                                                          : "sonject:first_slant_range_m");
    geometry->altitude_m = noted_number(file, "sonject:altitude_m");
    geometry->frequency_hz = noted_number(file, "sonject:frequency_hz");
    geometry->bandwidth_hz = noted_number(file, "sonject:bandwidth_hz");
    if (!swath_file_attribute(file, "sonject:side", side, sizeof side))
        side[0] = '\0';
    const bool is_starboard = strcmp(side, "starboard") == 0;
    geometry->knows_side = is_starboard || strcmp(side, "port") == 0;
    geometry->side = is_starboard ? SONJECT_SIDE_STARBOARD : SONJECT_SIDE_PORT;
}

void geometry_notes_read(const struct swath_file *file, struct noted_geometry *geometry)
{
    geometry->axis = swath_file_range_axis(file);
    if (swath_file_xtf(file))
        read_recording(swath_file_xtf(file), geometry);
    else
        read_texts(file, geometry);
}

sonject_status geometry_check_told(const sonject_geometry_params *geometry, struct report *report)
{
    struct check check = {report, NULL, SONJECT_OK};
    check_positive_length(&check, "row_spacing", geometry->row_spacing_m);
    check_positive_length(&check, "column_spacing", geometry->column_spacing_m);
    check_length(&check, "first_slant_range", geometry->first_slant_range_m);
    check_coordinate(&check, "first_along_track", geometry->first_along_track_m);
    return check.status;
}

bool geometry_notes_tell(const struct noted_geometry *noted, sonject_geometry_params *geometry)
{
    struct report unused = {{0}, NULL, NULL};
    sonject_geometry_params told = *geometry;
    told.row_spacing_m = noted->row_spacing_m;
    told.column_spacing_m = noted->column_spacing_m;
    told.first_along_track_m = noted->first_along_track_m;
    told.first_slant_range_m = noted->first_range_m;
    told.side = noted->side;
    if (noted->axis != RANGE_SLANT || !noted->knows_side ||
        geometry_check_told(&told, &unused) != SONJECT_OK)
        return false;
    *geometry = told;
    return true;
}
