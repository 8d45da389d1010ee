#include "io/recording.h"

#include "io/swath_file.h"

/* The rows of the scene's patch within the file; all zeros mean all rows. */
static sonject_status patch_rows(struct report *report, const struct scene *scene,
                                 const struct xtf_file *xtf, uint64_t *first, uint64_t *count)
{
    const uint64_t rows = xtf->rows.layout.rows;
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

static sonject_status take(struct report *report, const struct xtf_file *xtf, bool takes_geometry,
                           bool takes_altitude, struct scene *scene)
{
    uint64_t first, count;
    const sonject_status status = patch_rows(report, scene, xtf, &first, &count);
    if (status != SONJECT_OK)
        return status;
    const struct xtf_geometry geometry = xtf_geometry_of(xtf, first, count);
    if (takes_geometry && !(geometry.row_spacing_m > 0.0))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: has no positions, or the sonar stood still: give row_spacing, "
                              "column_spacing (%g m here) and first_slant_range (%g m) instead of "
                              "from_file",
                              scene->input_path, geometry.column_spacing_m,
                              geometry.first_slant_range_m);
    if (takes_altitude && !(geometry.altitude_m > 0.0))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: has no altitudes: give the sonar's altitude instead of "
                              "from_file",
                              scene->input_path);
    if (takes_geometry) {
        scene->geometry.row_spacing_m = geometry.row_spacing_m;
        scene->geometry.column_spacing_m = geometry.column_spacing_m;
        scene->geometry.first_slant_range_m = geometry.first_slant_range_m;
        scene->geometry.side = xtf->side == XTF_PORT ? SONJECT_SIDE_PORT : SONJECT_SIDE_STARBOARD;
    }
    if (takes_altitude)
        scene->sonar.altitude_m = geometry.altitude_m;
    return SONJECT_OK;
}

sonject_status recording_describe(struct report *report, bool takes_geometry, bool takes_altitude,
                                  struct scene *scene)
{
    struct swath_file *file;
    if (!scene->input_path)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "from_file needs an XTF file as input.path");
    sonject_status status =
        swath_file_open_array(report, scene->input_path, scene->channel, scene->array, &file);
    if (status != SONJECT_OK)
        return status;
    const struct xtf_file *xtf = swath_file_xtf(file);
    status = xtf ? take(report, xtf, takes_geometry, takes_altitude, scene)
                 : report_failure(report, SONJECT_ERROR_INPUT,
                                  "%s: is no XTF file, so it does not say where its pixels lie: "
                                  "give geometry and altitude",
                                  scene->input_path);
    swath_file_close(&file);
    return status;
}
