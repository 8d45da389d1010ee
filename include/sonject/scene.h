/* A scene: sonar, water, seabed, objects, and where the image comes from. */
#ifndef SONJECT_SCENE_H
#define SONJECT_SCENE_H

#include <stddef.h>
#include <stdint.h>

#include <sonject/context.h>
#include <sonject/export.h>

SONJECT_BEGIN_DECLARATIONS

typedef struct sonject_scene sonject_scene;

/* Capacity of names of objects, classes and splits, with the 0 at their end. */
#define SONJECT_NAME_CAPACITY 64

/* A scene is a text, YAML, whose keys are those of tools/scenes/KEYS.md, and what was set since. In
 * poses and lengths: x is along the track, heading is measured from it towards range (whichever
 * side the image shows), pitch raises the nose, roll is about it; burial is the depth of an
 * object's lowest point below the seabed. Pixel (n, j) is centred on track position
 * first_along_track + n * row_spacing and slant range first_slant_range + j * column_spacing, range
 * being reference sound speed * time / 2. A use of the scene reads and checks it, once until
 * something is set. */

/* An empty scene; sonar and input.geometry must be set before it is used. On success *scene is the
 * caller's, for sonject_scene_release; on failure NULL. Errors: ARGUMENT, MEMORY. */
SONJECT_API sonject_status sonject_scene_create(sonject_context *context, sonject_scene **scene);

/* How a scene is read. All 0: the file as it is. */
typedef struct sonject_scene_read_params {
    uint32_t struct_size;
    uint32_t override_count;
    const char *text;             /* the scene instead of a file, YAML (which JSON is); copied */
    const char *const *overrides; /* override_count strings "key.path=value" that replace or add
                                     keys, such as "input.path=swath.tif" or
                                     "objects[0].heading=30 deg" */
} sonject_scene_read_params;

/* Reads a scene file, or params->text. path: YAML file; of a text the name in messages, NULL for
 * "scene". Relative file names are resolved against path's folder, those of overrides and of a text
 * without path against the working directory. params may be NULL (all 0). A text may leave out
 * where the image comes from, for sonject_inject. Message on failure: file:line:column, the key,
 * what is wrong. On success *scene is the caller's, for sonject_scene_release; on failure NULL.
 * Errors: ARGUMENT, INPUT, STORAGE, UNSUPPORTED (a mesh's format), MEMORY. */
SONJECT_API sonject_status sonject_scene_read(sonject_context *context, const char *path,
                                              const sonject_scene_read_params *params,
                                              sonject_scene **scene);

/* Sets a key of the scene, one of tools/scenes/KEYS.md: key "sonar.altitude", value "10 m". A value
 * that begins with { [ " or ' is YAML (which JSON is): whole sections, lists and texts, such as
 * "objects[0]", "{shape: sphere, diameter: 1 m}", which replace what was there; the index behind a
 * list's last adds an entry. A number keeps all its digits ("%.17g"). Both are copied. Unknown keys
 * and what is no value are refused at once; values are checked by the first call that uses the
 * scene, with the same messages as a file's ("set sonar.altitude: what"). Relative file names are
 * resolved then, against the working directory. On failure the scene is unchanged. Errors:
 * ARGUMENT, INPUT, MEMORY. */
SONJECT_API sonject_status sonject_scene_set(sonject_scene *scene, const char *key,
                                             const char *value);

/* Sets a key whose value is the name of a table's file to numbers in memory, copied: values has
 * row_count rows of column_count numbers, which columns names as the file's first line would, such
 * as "along_track_m, sway_m". Keys: sonar.pulse.file, sonar.measured_response, sonar.motion.file,
 * sonar.motion.yaw.file, medium.profile.file, input.pings; and seabed.relief[N].heights.file, whose
 * numbers are those of an image's pixels, columns NULL. Keys beside it, such as sonar.pulse.kind,
 * are set by themselves. On failure the scene is unchanged. Errors: ARGUMENT, INPUT, MEMORY. */
SONJECT_API sonject_status sonject_scene_set_table(sonject_scene *scene, const char *key,
                                                   const char *columns, const double *values,
                                                   size_t row_count, size_t column_count);

/* What the scene says at a key, as JSON: "sonar.altitude" gives 10.0, "objects[0]" an object,
 * "objects" an array, "" the whole scene; null where it says nothing. Defaults and what a
 * calibration adds are not told. A quantity is the number that says the same without a unit:
 * in SI units and degrees. A text that is none stands as it is, and so do words. Names of
 * files are absolute. A table in memory is an object: columns, a text, null of heights, and values,
 * an array of rows. Nothing is checked but the key. *json is the caller's, for
 * sonject_text_release; on failure NULL. Errors: ARGUMENT (also a campaign's scene), INPUT (no such
 * key), MEMORY. */
SONJECT_API sonject_status sonject_scene_get(const sonject_scene *scene, const char *key,
                                             char **json);

/* The scene as text, with all that was set in its place: one that sonject_scene_read takes. Names
 * of files are absolute, so that it means the same wherever it is read; a table in memory is not in
 * it. *text is the caller's, for sonject_text_release; on failure NULL. Errors: ARGUMENT (also a
 * campaign's scene), MEMORY. */
SONJECT_API sonject_status sonject_scene_text(const sonject_scene *scene, char **text);

/* Files that have keys. */
typedef enum sonject_keys_of {
    SONJECT_KEYS_OF_SCENES = 0,
    SONJECT_KEYS_OF_CAMPAIGNS = 1
} sonject_keys_of;

/* All keys that files of a kind, a sonject_keys_of, have, as a JSON list of objects: path
 * ("objects[].heading"), section (the path of the one that it is in), meaning, kind (quantity,
 * count, flag, word, name, text, file, section, list or special), unit, has_value (it may be
 * written as one value), is_list, is_required (in its section), words (an array of them), default
 * and range in words, and preset, least and most in the SI unit; null where there is none. *json is
 * the caller's, for sonject_text_release; on failure NULL. Errors: ARGUMENT, MEMORY. */
SONJECT_API sonject_status sonject_keys(sonject_context *context, uint32_t of, char **json);

/* The names of the bands that a scene (section `bands`), read as sonject_scene_read would, leaves
 * to be chosen by an override such as "band=low": in the file's order, one a line, "" for a file
 * without bands or with one chosen. Of the scene nothing else is read. *names is the caller's, for
 * sonject_text_release. Errors: ARGUMENT, INPUT, STORAGE, MEMORY. */
SONJECT_API sonject_status sonject_scene_bands(sonject_context *context, const char *path,
                                               const sonject_scene_read_params *params,
                                               char **names);

/* Releases the scene and sets *scene to NULL; NULL allowed. */
SONJECT_API void sonject_scene_release(sonject_scene **scene);

/* Reads the scene first, where something was set. Errors: ARGUMENT, and as of sonject_scene_read.
 */
SONJECT_API sonject_status sonject_scene_object_count(const sonject_scene *scene, uint32_t *count);

/* Absorption of sea water in dB/m after Francois and Garrison (J. Acoust. Soc. Am. 72, 1982, 896
 * and 1879): frequency 200 Hz...1 MHz, temperature -2...30 degrees Celsius, salinity 0...40 per
 * mille, depth 0...5000 m below the sea surface, pH 7...9. NaN outside of these. */
SONJECT_API double sonject_absorption(double frequency_hz, double temperature_celsius,
                                      double salinity_permille, double depth_m, double ph);

SONJECT_END_DECLARATIONS

#endif
