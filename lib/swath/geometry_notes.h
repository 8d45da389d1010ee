/* The geometry that a file says of itself: a recording, or an image in texts that sonject writes
 * and reads. */
#ifndef SONJECT_SWATH_GEOMETRY_NOTES_H
#define SONJECT_SWATH_GEOMETRY_NOTES_H

#include "scene/scene.h"
#include "swath/raster_file.h"
#include "swath/swath_file.h"

#define GEOMETRY_NOTES_MAX 10

/* Where the pixels of a file lie and what made them, as far as it is known: NaN where it is not. */
struct noted_geometry {
    enum range_axis axis;
    double row_spacing_m, column_spacing_m; /* columns: along the axis */
    double first_along_track_m, first_range_m;
    double nadir_column;
    double altitude_m, frequency_hz, bandwidth_hz;
    bool altitude_varies; /* along a recorded line, so that the mean does not do */
    bool knows_side;
    uint32_t side; /* SONJECT_SIDE_... */
};

/* The texts and the attributes that point at them. */
struct geometry_notes {
    char texts[GEOMETRY_NOTES_MAX][48];
    struct raster_attribute attributes[GEOMETRY_NOTES_MAX];
    size_t count;
};

/* Texts of all that is known. */
void geometry_notes_make(struct geometry_notes *notes, const struct noted_geometry *geometry);

/* The same of a scene's image, whose pixel (0, 0) is the geometry's. */
void geometry_notes_init(struct geometry_notes *notes, const sonject_sonar_params *sonar,
                         const sonject_geometry_params *geometry);

/* What a file says: in such texts, or as a recording (means over all of it). Nothing of it is
 * checked but that numbers are finite. */
void geometry_notes_read(const struct swath_file *file, struct noted_geometry *geometry);

/* As parameters of a slant range image; false (and nothing changed) where they are not all known,
 * or are none that an image has. */
bool geometry_notes_tell(const struct noted_geometry *noted, sonject_geometry_params *geometry);

/* What a scene leaves to its input. */
struct recording_wish {
    bool geometry;
    enum altitude_source altitude_by;
    bool first_range; /* of a geometry that is given else */
};

/* Takes that from it: from a recording, of which spacing and altitude are the means over the
 * patch's rows, or from an image whose notes say them. Where the scene has a table of pings,
 * altitude and first range are its means over the patch's rows; first returns give an altitude
 * alike. Errors: INPUT (it does not say them: says what to give instead; ground range; a table that
 * has not all of the patch's rows, or first ranges that are more than a column apart; as
 * swath_file_open_array), UNSUPPORTED, STORAGE, MEMORY. On failure the scene is unchanged, and *key
 * is the key of the scene that the message is about. */
sonject_status recording_describe(struct report *report, const struct recording_wish *wish,
                                  struct scene *scene, const char **key);

/* The altitudes at the region's rows of the scene's input, m: the row's before it where none is
 * told. recording: the input; NULL for other files. */
void row_altitudes(const struct scene *scene, const struct recording *recording,
                   const struct region *region, double *altitudes);

#endif
