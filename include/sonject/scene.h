/* A scene: sonar, water, seabed, objects, and where the image comes from. */
#ifndef SONJECT_SCENE_H
#define SONJECT_SCENE_H

#include <stddef.h>
#include <stdint.h>

#include <sonject/context.h>
#include <sonject/export.h>

SONJECT_BEGIN_DECLARATIONS

typedef struct sonject_scene sonject_scene;

/* The capacity of names of objects, classes and splits, with the 0 at their end. */
#define SONJECT_NAME_CAPACITY 64

/* A scene is a text, YAML with the keys of tools/scenes/KEYS.md, and all that was set since. In
 * poses and lengths x is along the track. Heading is measured from x towards range (whichever side
 * the image shows), pitch raises the nose, roll is about x. Burial is the depth of an object's
 * lowest point below the seabed. Pixel (n, j) is centred on track position first_along_track + n *
 * row_spacing and slant range first_slant_range + j * column_spacing, where range is reference
 * sound speed * time / 2. The first use of a scene reads and checks it, and so does the first use
 * after a change. */

/* Makes an empty scene; set sonar and input.geometry before using it. On success *scene is the
 * caller's, for sonject_scene_release; on failure it is NULL. Errors: ARGUMENT, MEMORY. */
SONJECT_API sonject_status sonject_scene_create(sonject_context *context, sonject_scene **scene);

/* Options for reading a scene. All 0: the file as it is. */
typedef struct sonject_scene_read_params {
    uint32_t struct_size;
    uint32_t override_count;
    const char *text; /* scene as YAML (or JSON, which is YAML) instead of a file; copied */
    const char *const *overrides; /* override_count strings "key.path=value" that replace or add
                                     keys, such as "input.path=swath.tif" or
                                     "objects[0].heading=30 deg" */
} sonject_scene_read_params;

/* Reads a scene file, or params->text. path: YAML file; with a text the name in messages, NULL for
 * "scene". Relative file names are resolved against path's folder. Those of overrides, and of a
 * text without path, are resolved against the working directory. params may be NULL (all 0). A text
 * for sonject_inject may leave out where the image comes from. The message of a failure names
 * file:line:column, the key and the mistake. On success *scene is the caller's, for
 * sonject_scene_release; on failure it is NULL. Errors: ARGUMENT, INPUT, STORAGE, UNSUPPORTED (a
 * mesh's format), MEMORY. */
SONJECT_API sonject_status sonject_scene_read(sonject_context *context, const char *path,
                                              const sonject_scene_read_params *params,
                                              sonject_scene **scene);

/* Sets a key of the scene (tools/scenes/KEYS.md), such as key "sonar.altitude" to value "10 m". A
 * value that begins with { [ " or ' is YAML (or JSON): sections, lists and texts, such as "{shape:
 * sphere, diameter: 1 m}" for "objects[0]", which replace the old ones. The index behind a list's
 * last one adds an entry. A number keeps all its digits ("%.17g"). Both texts are copied. Unknown
 * keys and malformed values are refused at once. The first call that uses the scene checks the
 * values, with the same messages as for a file ("set sonar.altitude: what"), and resolves relative
 * file names against the working directory. On failure the scene is unchanged. Errors: ARGUMENT,
 * INPUT, MEMORY. */
SONJECT_API sonject_status sonject_scene_set(sonject_scene *scene, const char *key,
                                             const char *value);

/* Sets a key to a table in memory instead of a table's file; the numbers are copied. values:
 * row_count rows of column_count numbers. columns: their names, as in the file's first line, such
 * as "along_track_m, sway_m". Keys: sonar.pulse.file, sonar.measured_response, sonar.motion.file,
 * sonar.motion.yaw.file, medium.profile.file, input.pings; also seabed.relief[N].heights.file, with
 * the numbers of an image's pixels and columns NULL. Set neighbouring keys, such as
 * sonar.pulse.kind, separately. On failure the scene is unchanged. Errors: ARGUMENT, INPUT, MEMORY.
 */
SONJECT_API sonject_status sonject_scene_set_table(sonject_scene *scene, const char *key,
                                                   const char *columns, const double *values,
                                                   size_t row_count, size_t column_count);

/* Gets the value of a key as JSON: "sonar.altitude" gives 10.0, "objects[0]" an object, "objects"
 * an array, "" the whole scene. A key that the scene does not set gives null. Defaults and values
 * added by a calibration are left out. A quantity becomes a number in SI units or degrees, as the
 * scene takes it without a unit; words and other texts stay as they are. File names are absolute. A
 * table in memory is an object: columns, a text (null for heights), and values, an array of rows.
 * Only the key is checked. *json is the caller's, for sonject_text_release; on failure it is NULL.
 * Errors: ARGUMENT (also a campaign's scene), INPUT (no such key), MEMORY. */
SONJECT_API sonject_status sonject_scene_get(const sonject_scene *scene, const char *key,
                                             char **json);

/* Gets the scene, with all that was set, as a text for sonject_scene_read. File names are absolute,
 * so that the text means the same wherever it is read; tables in memory are left out. *text is the
 * caller's, for sonject_text_release; on failure it is NULL. Errors: ARGUMENT (also a campaign's
 * scene), MEMORY. */
SONJECT_API sonject_status sonject_scene_text(const sonject_scene *scene, char **text);

/* The kinds of files that have keys. */
typedef enum sonject_keys_of {
    SONJECT_KEYS_OF_SCENES = 0,
    SONJECT_KEYS_OF_CAMPAIGNS = 1
} sonject_keys_of;

/* Lists all keys of a kind of files (of: a sonject_keys_of) as a JSON list of objects. Members:
 * path ("objects[].heading"), section (the path of its section), meaning, kind (quantity, count,
 * flag, word, name, text, file, section, list or special), unit, has_value (one value can be
 * given), is_list, is_required (in its section), words (an array of them), default and range in
 * words, and preset, least and most in the SI unit; null: none. *json is the caller's, for
 * sonject_text_release; on failure it is NULL. Errors: ARGUMENT, MEMORY. */
SONJECT_API sonject_status sonject_keys(sonject_context *context, uint32_t of, char **json);

/* Lists the bands (section `bands`) from which an override such as "band=low" must choose.
 * Arguments are those of sonject_scene_read; nothing else of the scene is read. *names gets one
 * name a line, in the file's order, or "" for a file without bands or with one chosen. *names is
 * the caller's, for sonject_text_release. Errors: ARGUMENT, INPUT, STORAGE, MEMORY. */
SONJECT_API sonject_status sonject_scene_bands(sonject_context *context, const char *path,
                                               const sonject_scene_read_params *params,
                                               char **names);

/* Releases the scene and sets *scene to NULL; NULL allowed. */
SONJECT_API void sonject_scene_release(sonject_scene **scene);

/* Gets the number of objects; reads the scene first if something was set. Errors: ARGUMENT, and as
 * of sonject_scene_read. */
SONJECT_API sonject_status sonject_scene_object_count(const sonject_scene *scene, uint32_t *count);

/* Returns the absorption of sea water in dB/m after Francois and Garrison (J. Acoust. Soc. Am. 72,
 * 1982, 896 and 1879). Frequency 200 Hz...1 MHz, temperature -2...30 degrees Celsius, salinity
 * 0...40 per mille, depth 0...5000 m below the sea surface, pH 7...9; NaN outside these ranges. */
SONJECT_API double sonject_absorption(double frequency_hz, double temperature_celsius,
                                      double salinity_permille, double depth_m, double ph);

SONJECT_END_DECLARATIONS

#endif
