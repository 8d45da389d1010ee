#include "swath/geometry_notes.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"

#define DIGITS 9
#define OTHERS 200 /* bytes */

/* The numbers, in the order of the notes. */
static const struct {
    const char *name, *ground_name; /* ground_name: in ground range; NULL: as name */
    size_t place;
} numbers[] = {
    {"sonject:frequency_hz", NULL, offsetof(struct noted_geometry, frequency_hz)},
    {"sonject:bandwidth_hz", NULL, offsetof(struct noted_geometry, bandwidth_hz)},
    {"sonject:altitude_m", NULL, offsetof(struct noted_geometry, altitude_m)},
    {"sonject:row_spacing_m", NULL, offsetof(struct noted_geometry, row_spacing_m)},
    {"sonject:column_spacing_m", NULL, offsetof(struct noted_geometry, column_spacing_m)},
    {"sonject:first_along_track_m", NULL, offsetof(struct noted_geometry, first_along_track_m)},
    {"sonject:first_slant_range_m", "sonject:first_ground_range_m",
     offsetof(struct noted_geometry, first_range_m)},
    {"sonject:nadir_column", NULL, offsetof(struct noted_geometry, nadir_column)},
};
#define NUMBERS (sizeof numbers / sizeof *numbers)

static const char *number_name(size_t i, const struct noted_geometry *geometry)
{
    return geometry->axis == RANGE_GROUND && numbers[i].ground_name ? numbers[i].ground_name
                                                                    : numbers[i].name;
}

static void note(struct geometry_notes *notes, const char *name, const char *text)
{
    notes->attributes[notes->count].name = name;
    notes->attributes[notes->count++].value = text;
}

void geometry_notes_make(struct geometry_notes *notes, const struct noted_geometry *geometry)
{
    memset(notes, 0, sizeof *notes);
    for (size_t i = 0; i < NUMBERS; i++) {
        char *text = notes->texts[notes->count];
        double number;
        memcpy(&number, (const char *)geometry + numbers[i].place, sizeof number);
        if (isfinite(number))
            note(notes, number_name(i, geometry),
                 text_of_number(text, sizeof notes->texts[0], number, DIGITS));
    }
    if (geometry->full_scale > 0.0) {
        char *text = notes->texts[notes->count];
        snprintf(text, sizeof notes->texts[0], "%.0f", geometry->full_scale);
        note(notes, FULL_SCALE_NOTE, text);
    }
    if (geometry->knows_side)
        note(notes, "sonject:side",
             geometry->side == SONJECT_SIDE_STARBOARD ? "starboard" : "port");
    if (geometry->axis != RANGE_UNKNOWN)
        note(notes, "sonject:range_axis", geometry->axis == RANGE_GROUND ? "ground" : "slant");
}

void geometry_notes_init(struct geometry_notes *notes, const sonject_sonar_params *sonar,
                         const sonject_geometry_params *geometry)
{
    const struct noted_geometry noted = {
        .axis = RANGE_SLANT,
        .row_spacing_m = geometry->row_spacing_m,
        .column_spacing_m = geometry->column_spacing_m,
        .first_along_track_m = geometry->first_along_track_m,
        .first_range_m = geometry->first_slant_range_m,
        .nadir_column = geometry->nadir_column > 0.0 ? geometry->nadir_column : NAN,
        .altitude_m = sonar->altitude_m,
        .frequency_hz = sonar->centre_frequency_hz,
        .bandwidth_hz = sonar->bandwidth_hz,
        .knows_side = true,
        .side = geometry->side,
    };
    geometry_notes_make(notes, &noted);
}

static void read_recording(const struct recording *recording, struct noted_geometry *geometry)
{
    const struct recording_geometry told = recording_geometry_of(recording, 0, recording->rows);
    geometry->row_spacing_m = told.row_spacing_m > 0.0 ? told.row_spacing_m : NAN;
    geometry->column_spacing_m = told.column_spacing_m;
    geometry->first_along_track_m = 0.0;
    geometry->first_range_m = told.first_slant_range_m;
    geometry->altitude_m = told.altitude_m > 0.0 ? told.altitude_m : NAN;
    geometry->altitude_varies = recording_altitude_varies(&told);
    geometry->frequency_hz = geometry->bandwidth_hz = geometry->nadir_column = NAN;
    geometry->knows_side = true;
    geometry->side = recording->side == RECORDED_PORT ? SONJECT_SIDE_PORT : SONJECT_SIDE_STARBOARD;
}

static void read_texts(const struct swath_file *file, struct noted_geometry *geometry)
{
    char text[64];
    for (size_t i = 0; i < NUMBERS; i++) {
        const char *rest;
        double number;
        if (!swath_file_attribute(file, number_name(i, geometry), text, sizeof text) ||
            !text_to_number(text, &number, &rest) || *rest || !isfinite(number))
            number = NAN;
        memcpy((char *)geometry + numbers[i].place, &number, sizeof number);
    }
    if (!swath_file_attribute(file, "sonject:side", text, sizeof text))
        *text = '\0';
    const bool is_starboard = strcmp(text, "starboard") == 0;
    geometry->knows_side = is_starboard || strcmp(text, "port") == 0;
    geometry->side = is_starboard ? SONJECT_SIDE_STARBOARD : SONJECT_SIDE_PORT;
}

static void read_grey_levels(const struct swath_file *file, double grey_db[2])
{
    char text[GREY_TEXT];
    const char *rest;
    if (!swath_file_attribute(file, GREY_ATTRIBUTE, text, sizeof text) ||
        !text_to_number(text, &grey_db[0], &rest) || strncmp(rest, " dB, ", 5) != 0 ||
        !text_to_number(rest + 5, &grey_db[1], &rest) || !(grey_db[0] < grey_db[1]))
        grey_db[0] = grey_db[1] = 0.0;
}

void geometry_notes_read(const struct swath_file *file, struct noted_geometry *geometry)
{
    geometry->axis = swath_file_range_axis(file);
    geometry->full_scale = (double)swath_file_largest(file);
    read_grey_levels(file, geometry->grey_db);
    if (swath_file_recording(file))
        read_recording(swath_file_recording(file), geometry);
    else
        read_texts(file, geometry);
}

/* Checks that lengths from a file are within a sonar's limits. */
static sonject_status check_told(const sonject_geometry_params *geometry, struct report *report)
{
    struct check check = {report, NULL, SONJECT_OK};
    check_positive_length(&check, "row_spacing", geometry->row_spacing_m);
    check_positive_length(&check, "column_spacing", geometry->column_spacing_m);
    check_length(&check, "first_slant_range", geometry->first_slant_range_m);
    check_coordinate(&check, "first_along_track", geometry->first_along_track_m);
    check_length(&check, "nadir_column", geometry->nadir_column);
    return check.status;
}

bool geometry_notes_to_params(const struct noted_geometry *noted, sonject_geometry_params *geometry)
{
    struct report unused = {.host = NULL};
    sonject_geometry_params told = *geometry;
    told.row_spacing_m = noted->row_spacing_m;
    told.column_spacing_m = noted->column_spacing_m;
    told.first_along_track_m = noted->first_along_track_m;
    told.first_slant_range_m = noted->first_range_m;
    told.nadir_column = isnan(noted->nadir_column) ? 0.0 : noted->nadir_column;
    told.side = noted->side;
    if (noted->axis != RANGE_SLANT || !noted->knows_side ||
        check_told(&told, &unused) != SONJECT_OK)
        return false;
    *geometry = told;
    return true;
}

static bool is_another(double files, double given)
{
    return fabs(given - files) > 0.05 * fabs(files);
}

static void add_other(char text[OTHERS], const char *before, double files, const char *behind,
                      double given)
{
    const size_t length = strlen(text);
    snprintf(text + length, OTHERS - length, "%s%s %.4g m%s, not %.4g", length > 0 ? ", " : "",
             before, files, behind, given);
}

void tell_other_geometry(struct report *report, const char *path,
                         const sonject_geometry_params *files, const sonject_geometry_params *given)
{
    const double columns = fabs(files->column_spacing_m), told = fabs(given->column_spacing_m);
    char others[OTHERS] = "";
    if (is_another(files->row_spacing_m, given->row_spacing_m))
        add_other(others, "rows of", files->row_spacing_m, "", given->row_spacing_m);
    if (is_another(columns, told))
        add_other(others, "columns of", columns, "", told);
    /* a first range is as good as known within a metre */
    if (files->nadir_column == given->nadir_column &&
        fabs(files->first_slant_range_m - given->first_slant_range_m) > 1.0 &&
        is_another(files->first_slant_range_m, given->first_slant_range_m))
        add_other(others, "from", files->first_slant_range_m, " on", given->first_slant_range_m);
    if (*others)
        report_note(report,
                    "%s tells other spacings and ranges than the scene: %s; input.geometry: "
                    "from_file takes the file's",
                    path, others);
}

void tell_grey_levels(struct report *report, const char *path, const double grey_db[2],
                      const sonject_transfer_params *transfer)
{
    if (grey_db[0] < grey_db[1] && transfer->kind != SONJECT_TRANSFER_DECIBEL)
        report_note(report,
                    "%s says that its numbers are grey levels from %g to %g dB: set input.transfer "
                    "to {kind: decibel, parameter: %g, offset: %g dB}",
                    path, grey_db[0], grey_db[1], (grey_db[1] - grey_db[0]) / 255.0, grey_db[0]);
}

/* Finds the rows of the scene's patch in the file. A patch of all zeros means all rows. */
static sonject_status patch_rows(struct report *report, const struct scene *scene, uint64_t rows,
                                 uint64_t *first, uint64_t *count)
{
    *first = scene->patch.first_row;
    *count = scene->patch.rows > 0 ? scene->patch.rows : rows;
    if (*first >= rows || *count > rows - *first) {
        if (scene->patch.rows > 0 || *first >= rows)
            return input_failure(report, scene->input_path,
                                 "has %llu rows: the patch's rows %llu to %llu are not among them",
                                 (unsigned long long)rows, (unsigned long long)*first,
                                 (unsigned long long)(*first + *count - 1));
        *count = rows - *first;
    }
    return SONJECT_OK;
}

/* The wish, and the values found for it. */
struct wanted {
    struct recording_wish wish;
    const char **key; /* gets the scene's key that a failure is about */
    sonject_geometry_params where;
    double altitude_m, altitudes_m[2];
};

/* Checks that a table of pings has all of the patch's rows. */
static sonject_status check_ping_rows(struct report *report, const struct ping_table *pings,
                                      uint64_t rows, uint64_t first, uint64_t count)
{
    const double start = pings->rows[0];
    const double end = pings->rows[pings->count - 1];
    if (start < 0.0 || end > (double)(rows - 1))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "has rows from %g to %g, the image those from 0 to %llu: correct the "
                              "table's rows",
                              start, end, (unsigned long long)(rows - 1));
    if (start > (double)first || end < (double)(first + count - 1))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "has rows from %g to %g, too few for the patch's, %llu to %llu: add "
                              "some, or choose another patch",
                              start, end, (unsigned long long)first,
                              (unsigned long long)(first + count - 1));
    return SONJECT_OK;
}

/* Finds the rows of a whole line that the objects span. Returns false if there are no objects, or
 * if one lies outside the line. */
static bool rows_of_objects(const struct scene *scene, uint64_t rows, double row_spacing_m,
                            uint64_t *first, uint64_t *count)
{
    double low = INFINITY, high = -INFINITY;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const sonject_object_params *object = &scene->objects[i];
        double row = 0.5 * (double)(rows - 1);
        if (object->position_kind == SONJECT_POSITION_PIXELS)
            row = object->position_along;
        else if (object->position_kind == SONJECT_POSITION_METRES)
            row = (object->position_along - scene->geometry.first_along_track_m) / row_spacing_m;
        low = fmin(low, row);
        high = fmax(high, row);
    }
    if (!(low >= 0.0 && low <= high && high <= (double)(rows - 1)))
        return false;
    *first = (uint64_t)low;
    *count = (uint64_t)ceil(high) - *first + 1;
    return true;
}

/* Keeps the altitude. If it varies and no patch is chosen, keeps its range, which is reported. */
static void keep_altitude(const struct scene *scene, const struct recording_geometry *geometry,
                          struct wanted *wanted)
{
    wanted->altitude_m = geometry->altitude_m;
    if (scene->patch.rows == 0 && scene->object_count > 0 && recording_altitude_varies(geometry)) {
        wanted->altitudes_m[0] = geometry->lowest_altitude_m;
        wanted->altitudes_m[1] = geometry->highest_altitude_m;
    }
}

/* Takes the mean altitude over the patch's rows, or over the objects' rows if no patch is chosen.
 * The source is a table of pings, or first returns. */
static void take_row_altitudes(const struct scene *scene, uint64_t rows, uint64_t first,
                               uint64_t count, struct wanted *wanted)
{
    const struct ping_table *pings = &scene->pings;
    const bool by_returns = wanted->wish.altitude_by == ALTITUDE_OF_RETURNS;
    struct recording_geometry told = {.lowest_altitude_m = INFINITY};
    if (scene->patch.rows == 0)
        (void)rows_of_objects(scene, rows, wanted->where.row_spacing_m, &first, &count);
    for (uint64_t row = first; row < first + count; row++) {
        const double altitude = by_returns
                                    ? first_return_range(&scene->first_returns, &wanted->where, row)
                                    : ping_table_at(pings, pings->altitudes_m, (double)row);
        told.altitude_m += altitude / (double)count;
        told.lowest_altitude_m = fmin(told.lowest_altitude_m, altitude);
        told.highest_altitude_m = fmax(told.highest_altitude_m, altitude);
    }
    keep_altitude(scene, &told, wanted);
}

static sonject_status take_returns(struct report *report, const struct scene *scene, uint64_t rows,
                                   struct wanted *wanted)
{
    const struct first_return_list *returns = &scene->first_returns;
    uint64_t first, count;
    *wanted->key = "sonar.altitude";
    if (scene->calibrates_itself)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "first_return needs a calibration that already exists: make one "
                              "(sonject calibrate IMAGE -o FILE), and name it instead of auto");
    if (returns->count == 0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "first_return needs an input.calibration that has first returns "
                              "(measured.first_return): give a number instead");
    if ((rows - 1) / returns->every != returns->count - 1)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s has first returns of another image, not of one with %llu rows: "
                              "calibrate this image",
                              scene->calibration, (unsigned long long)rows);
    *wanted->key = "patch";
    CHECK(patch_rows(report, scene, rows, &first, &count));
    take_row_altitudes(scene, rows, first, count, wanted);
    return SONJECT_OK;
}

/* Takes the altitude and the mean first range over the patch's rows. */
static sonject_status take_pings(struct report *report, const struct scene *scene, uint64_t rows,
                                 struct wanted *wanted)
{
    const struct ping_table *pings = &scene->pings;
    const double *ranges = pings->first_ranges_m;
    uint64_t first, count;
    double nearest = INFINITY;
    double farthest = 0.0;
    *wanted->key = "patch";
    CHECK(patch_rows(report, scene, rows, &first, &count));
    *wanted->key = "input.pings";
    CHECK(check_ping_rows(report, pings, rows, first, count));
    if (wanted->wish.altitude_by == ALTITUDE_RECORDED)
        take_row_altitudes(scene, rows, first, count, wanted);
    double mean = 0.0;
    for (uint64_t row = first; row < first + count; row++) {
        const double range = ranges ? ping_table_at(pings, ranges, (double)row) : 0.0;
        mean += range / (double)count;
        nearest = fmin(nearest, range);
        farthest = fmax(farthest, range);
    }
    if (!wanted->wish.first_range)
        return SONJECT_OK;
    if (!ranges)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "has no column first_slant_range_m, which "
                              "input.geometry.first_slant_range: from_file needs");
    if (farthest - nearest > 2.0 * wanted->where.column_spacing_m)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "first_slant_range_m is from %.3f to %.3f m over the patch's rows, "
                              "more than a column of %g m from its mean: choose fewer rows",
                              nearest, farthest, wanted->where.column_spacing_m);
    wanted->where.first_slant_range_m = mean;
    return SONJECT_OK;
}

/* Returns whether the altitude comes from the input file itself. */
static bool takes_altitude(const struct scene *scene, const struct wanted *wanted)
{
    return wanted->wish.altitude_by == ALTITUDE_RECORDED && scene->pings.count == 0;
}

/* Takes geometry and altitude of a recording. A patch's row spacing is the mean of its own pings.
 * The picture of the whole line has the mean of all pings, and the patch's middle lies where that
 * picture has it. A line that ends where it began has no such mean. Without a patch, the altitude
 * is that at the objects' pings: a line's mean, and so every shadow, may be far off there. */
static sonject_status take_recording(struct report *report, const struct scene *scene,
                                     const struct recording *recording, struct wanted *wanted)
{
    uint64_t first, count;
    struct noted_geometry line;
    *wanted->key = "patch";
    CHECK(patch_rows(report, scene, recording->rows, &first, &count));
    const struct recording_geometry geometry = recording_geometry_of(recording, first, count);
    *wanted->key = "input.geometry";
    if (wanted->wish.geometry && !(geometry.row_spacing_m > 0.0))
        return input_failure(report, scene->input_path,
                             "%s: give row_spacing, column_spacing (%g m here) and "
                             "first_slant_range (%g m) instead of from_file",
                             isnan(geometry.row_spacing_m)
                                 ? "fewer than two of its pings have a position"
                                 : "the patch's pings all have the same position",
                             geometry.column_spacing_m, geometry.first_slant_range_m);
    read_recording(recording, &line);
    const double middle = (double)first + 0.5 * (double)(count - 1);
    wanted->where.first_along_track_m =
        line.row_spacing_m > 0.0 ? (line.row_spacing_m - geometry.row_spacing_m) * middle : 0.0;
    wanted->where.row_spacing_m = geometry.row_spacing_m;
    wanted->where.column_spacing_m = geometry.column_spacing_m;
    wanted->where.first_slant_range_m = geometry.first_slant_range_m;
    wanted->where.side = line.side;
    if (!takes_altitude(scene, wanted))
        return SONJECT_OK;
    if (scene->patch.rows == 0)
        (void)rows_of_objects(scene, recording->rows,
                              wanted->wish.geometry ? geometry.row_spacing_m
                                                    : scene->geometry.row_spacing_m,
                              &first, &count);
    const struct recording_geometry there = recording_geometry_of(recording, first, count);
    *wanted->key = "sonar.altitude";
    if (!(there.altitude_m > 0.0))
        return input_failure(report, scene->input_path,
                             "has no altitudes: give the sonar's altitude instead of from_file");
    keep_altitude(scene, &there, wanted);
    return SONJECT_OK;
}

static sonject_status take_notes(struct report *report, const struct scene *scene,
                                 const struct swath_file *file, struct wanted *wanted)
{
    struct noted_geometry noted;
    geometry_notes_read(file, &noted);
    *wanted->key = "input.geometry";
    if (noted.axis == RANGE_GROUND)
        return input_failure(report, scene->input_path,
                             "is in ground range, and runs work in slant range: convert it first "
                             "with sonject convert --range-axis slant");
    if (wanted->wish.geometry && !geometry_notes_to_params(&noted, &wanted->where))
        return input_failure(
            report, scene->input_path,
            "does not say where its pixels lie, as XTF and JSF files do and what sonject convert "
            "makes of "
            "them: give row_spacing, column_spacing and first_slant_range instead of from_file");
    *wanted->key = "sonar.altitude";
    if (takes_altitude(scene, wanted) && !(noted.altitude_m > 0.0))
        return input_failure(report, scene->input_path,
                             "does not say the sonar's altitude: give it instead of from_file");
    wanted->altitude_m = noted.altitude_m;
    return SONJECT_OK;
}

/* Checks the values, since files may say anything, and sets them in the scene. */
static sonject_status check_and_set(struct report *report, const struct wanted *wanted,
                                    struct scene *scene)
{
    struct report why = {.host = NULL};
    struct check check = {&why, NULL, SONJECT_OK};
    const bool takes_geometry = wanted->wish.geometry || wanted->wish.first_range;
    *wanted->key = "input.geometry";
    if (takes_geometry)
        check.status = check_told(&wanted->where, &why);
    if (check.status == SONJECT_OK)
        *wanted->key = "sonar.altitude";
    if (wanted->wish.altitude_by != ALTITUDE_GIVEN)
        check_positive_length(&check, "altitude", wanted->altitude_m);
    if (check.status != SONJECT_OK)
        return input_failure(report, scene->input_path,
                             "its %s: give a right one instead of from_file", why.message);
    if (takes_geometry)
        scene->geometry = wanted->where;
    if (wanted->wish.altitude_by != ALTITUDE_GIVEN) {
        scene->sonar.altitude_m = wanted->altitude_m;
        memcpy(scene->altitudes_m, wanted->altitudes_m, sizeof scene->altitudes_m);
    }
    scene->altitude_by = wanted->wish.altitude_by;
    return SONJECT_OK;
}

sonject_status recording_describe(struct report *report, const struct recording_wish *wish,
                                  struct scene *scene, const char **key)
{
    struct swath_file *file;
    struct wanted wanted = {*wish, key, scene->geometry, 0.0, {0.0, 0.0}};
    *key = "input";
    if (!scene->input_path)
        return report_failure(report, SONJECT_ERROR_INPUT, "from_file needs a file as input.path");
    *key = "input.geometry.first_slant_range";
    if (wish->first_range && scene->pings.count == 0)
        return report_failure(report, SONJECT_ERROR_INPUT, "from_file needs input.pings");
    *key = "input";
    sonject_status status =
        swath_file_open_array(report, scene->input_path, scene->channel, scene->array, &file);
    if (status != SONJECT_OK)
        return status;
    const struct recording *recording = swath_file_recording(file);
    struct raster_layout layout;
    swath_file_layout(file, &layout);
    if (wish->geometry || takes_altitude(scene, &wanted))
        status = recording ? take_recording(report, scene, recording, &wanted)
                           : take_notes(report, scene, file, &wanted);
    if (status == SONJECT_OK && scene->pings.count > 0)
        status = take_pings(report, scene, layout.rows, &wanted);
    if (status == SONJECT_OK && wish->altitude_by == ALTITUDE_OF_RETURNS)
        status = take_returns(report, scene, layout.rows, &wanted);
    THEN(status, check_and_set(report, &wanted, scene));
    swath_file_close(&file);
    return status;
}

/* Returns 0 if the row's altitude is unknown. */
static double row_altitude(const struct scene *scene, const struct recording *recording,
                           uint64_t row)
{
    const struct ping_table *pings = &scene->pings;
    if (scene->altitude_by == ALTITUDE_GIVEN)
        return scene->sonar.altitude_m;
    if (scene->altitude_by == ALTITUDE_OF_RETURNS)
        return first_return_range(&scene->first_returns, &scene->geometry, row);
    if (pings->count == 0)
        return recording ? (double)recording->pings[row].altitude_m : scene->sonar.altitude_m;
    const double last = pings->rows[pings->count - 1];
    return ping_table_at(pings, pings->altitudes_m, fmin(fmax((double)row, pings->rows[0]), last));
}

void row_altitudes(const struct scene *scene, const struct recording *recording,
                   const struct region *region, double *altitudes)
{
    double altitude = scene->sonar.altitude_m;
    for (uint64_t i = 0; i < region->rows; i++) {
        const double told = row_altitude(scene, recording, region->first_row + i);
        altitudes[i] = altitude = told > 0.0 ? told : altitude;
    }
}
