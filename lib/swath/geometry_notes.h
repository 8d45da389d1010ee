/* The geometry that a file states: a recording's, or texts that sonject stores with an image. */
#ifndef SONJECT_SWATH_GEOMETRY_NOTES_H
#define SONJECT_SWATH_GEOMETRY_NOTES_H

#include "scene/scene.h"
#include "swath/raster_file.h"
#include "swath/swath_file.h"

#define GEOMETRY_NOTES_MAX 11

/* The geometry of a file's pixels and the sonar's data; NaN where unknown. */
struct noted_geometry {
    enum range_axis axis;
    double row_spacing_m, column_spacing_m; /* column spacing: along the axis */
    double first_along_track_m, first_range_m;
    double nadir_column;
    double altitude_m, frequency_hz, bandwidth_hz;
    double full_scale;    /* see FULL_SCALE_NOTE; 0: the type's */
    double grey_db[2];    /* black and white of raster_make_grey; both 0: other numbers */
    bool altitude_varies; /* the altitude changes too much along the line for a mean */
    bool knows_side;
    uint32_t side; /* SONJECT_SIDE_... */
};

/* The texts, and the attributes that point at the texts. */
struct geometry_notes {
    char texts[GEOMETRY_NOTES_MAX][48];
    struct raster_attribute attributes[GEOMETRY_NOTES_MAX];
    size_t count;
};

/* Makes notes of all known values. */
void geometry_notes_make(struct geometry_notes *notes, const struct noted_geometry *geometry);

/* Makes the notes of a scene's image, whose pixel (0, 0) is the geometry's. */
void geometry_notes_init(struct geometry_notes *notes, const sonject_sonar_params *sonar,
                         const sonject_geometry_params *geometry);

/* Reads what a file says, in such texts or as a recording (means over all rows). Checks only that
 * numbers are finite. */
void geometry_notes_read(const struct swath_file *file, struct noted_geometry *geometry);

/* Turns noted geometry into parameters of a slant range image. Returns false and changes nothing if
 * some are unknown or out of range. */
bool geometry_notes_to_params(const struct noted_geometry *noted,
                              sonject_geometry_params *geometry);

/* Notes where the geometry that a scene gives is not the file's own, within a twentieth. */
void tell_other_geometry(struct report *report, const char *path,
                         const sonject_geometry_params *files,
                         const sonject_geometry_params *given);

/* Notes where a file's pixels are grey levels in dB and the scene's curve is another. */
void tell_grey_levels(struct report *report, const char *path, const double grey_db[2],
                      const sonject_transfer_params *transfer);

/* The values that a scene leaves to its input. */
struct recording_wish {
    bool geometry;
    enum altitude_source altitude_by;
    bool first_range; /* the first range alone; the scene gives the rest */
};

/* Takes the wished values from the input. Spacing and altitude of a recording are means over the
 * patch's rows; an image must have notes of them. With a table of pings, altitude and first range
 * are the table's means over the patch's rows. First returns give an altitude in the same way.
 * Errors: INPUT (a value is missing, and the message says what to give instead; ground range; a
 * table without some of the patch's rows, or whose first ranges span more than two columns there;
 * see swath_file_open_array), UNSUPPORTED, STORAGE, MEMORY. On failure the scene is unchanged, and
 * *key is the scene's key that the message is about. */
sonject_status recording_describe(struct report *report, const struct recording_wish *wish,
                                  struct scene *scene, const char **key);

/* Finds the altitude at each of the region's rows, m. A row without one has that of the row before.
 * recording: the scene's input; NULL for other files. */
void row_altitudes(const struct scene *scene, const struct recording *recording,
                   const struct region *region, double *altitudes);

#endif
