#include "swath/recording.h"

#include <math.h>

#include "base/ranges.h"
#include "swath/geometry_notes.h"

/* The rows of the scene's patch within the file; all zeros mean all rows. */
static sonject_status patch_rows(struct report *report, const struct scene *scene,
                                 const struct xtf_file *xtf, uint64_t *first, uint64_t *count)
{
    const uint64_t rows = xtf->rows;
    *first = scene->patch.first_row;
    *count = scene->patch.rows > 0 ? scene->patch.rows : rows;
    if (*first >= rows || *count > rows - *first) {
        if (scene->patch.rows > 0 || *first >= rows)
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "%s: has %llu pings: the patch's rows %llu to %llu are not among "
                                  "them",
                                  scene->input_path, (unsigned long long)rows,
                                  (unsigned long long)*first,
                                  (unsigned long long)(*first + *count - 1));
        *count = rows - *first;
    }
    return SONJECT_OK;
}

/* What is asked for, and where it goes. */
struct wanted {
    bool geometry, altitude;
    const char **key; /* gets the scene's key that a failure is about */
    sonject_geometry_params where;
    double altitude_m;
};

static sonject_status take_recording(struct report *report, const struct scene *scene,
                                     const struct xtf_file *xtf, struct wanted *wanted)
{
    uint64_t first, count;
    *wanted->key = "patch";
    CHECK(patch_rows(report, scene, xtf, &first, &count));
    const struct xtf_geometry geometry = xtf_geometry_of(xtf, first, count);
    *wanted->key = "input.geometry";
    if (wanted->geometry && !(geometry.row_spacing_m > 0.0))
        return report_failure(
            report, SONJECT_ERROR_INPUT,
            "%s: %s: give row_spacing, column_spacing (%g m here) and first_slant_range (%g m) "
            "instead of from_file",
            scene->input_path,
            isnan(geometry.row_spacing_m) ? "fewer than two of its pings have a position"
                                          : "the patch's pings all have the same position",
            geometry.column_spacing_m, geometry.first_slant_range_m);
    *wanted->key = "sonar.altitude";
    if (wanted->altitude && !(geometry.altitude_m > 0.0))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: has no altitudes: give the sonar's altitude instead of "
                              "from_file",
                              scene->input_path);
    wanted->where.row_spacing_m = geometry.row_spacing_m;
    wanted->where.column_spacing_m = geometry.column_spacing_m;
    wanted->where.first_slant_range_m = geometry.first_slant_range_m;
    wanted->where.side = xtf->side == XTF_PORT ? SONJECT_SIDE_PORT : SONJECT_SIDE_STARBOARD;
    wanted->altitude_m = geometry.altitude_m;
    return SONJECT_OK;
}

static sonject_status take_notes(struct report *report, const struct scene *scene,
                                 const struct swath_file *file, struct wanted *wanted)
{
    struct noted_geometry noted;
    geometry_notes_read(file, &noted);
    *wanted->key = "input.geometry";
    if (noted.axis == RANGE_GROUND)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: is in ground range, and runs work in slant range: convert it "
                              "first with sonject convert --range-axis slant",
                              scene->input_path);
    if (wanted->geometry && !geometry_notes_tell(&noted, &wanted->where))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: does not say where its pixels lie, as XTF files do and what "
                              "sonject convert makes of them: give row_spacing, column_spacing and "
                              "first_slant_range instead of from_file",
                              scene->input_path);
    *wanted->key = "sonar.altitude";
    if (wanted->altitude && !(noted.altitude_m > 0.0))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: does not say the sonar's altitude: give it instead of from_file",
                              scene->input_path);
    wanted->altitude_m = noted.altitude_m;
    return SONJECT_OK;
}

/* Files may say anything. */
static sonject_status check_and_set(struct report *report, const struct wanted *wanted,
                                    struct scene *scene)
{
    struct report why = {{0}, NULL, NULL};
    struct check check = {&why, NULL, SONJECT_OK};
    *wanted->key = "input.geometry";
    if (wanted->geometry)
        check.status = geometry_check_told(&wanted->where, &why);
    if (check.status == SONJECT_OK)
        *wanted->key = "sonar.altitude";
    if (wanted->altitude)
        check_positive_length(&check, "altitude", wanted->altitude_m);
    if (check.status != SONJECT_OK)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: its %s: give a right one instead of from_file",
                              scene->input_path, why.message);
    if (wanted->geometry)
        scene->geometry = wanted->where;
    if (wanted->altitude)
        scene->sonar.altitude_m = wanted->altitude_m;
    scene->has_recorded_altitude = wanted->altitude;
    return SONJECT_OK;
}

sonject_status recording_describe(struct report *report, bool takes_geometry, bool takes_altitude,
                                  struct scene *scene, const char **key)
{
    struct swath_file *file;
    struct wanted wanted = {takes_geometry, takes_altitude, key, scene->geometry, 0.0};
    *key = "input";
    if (!scene->input_path)
        return report_failure(report, SONJECT_ERROR_INPUT, "from_file needs a file as input.path");
    sonject_status status =
        swath_file_open_array(report, scene->input_path, scene->channel, scene->array, &file);
    if (status != SONJECT_OK)
        return status;
    const struct xtf_file *xtf = swath_file_xtf(file);
    status = xtf ? take_recording(report, scene, xtf, &wanted)
                 : take_notes(report, scene, file, &wanted);
    THEN(status, check_and_set(report, &wanted, scene));
    swath_file_close(&file);
    return status;
}
