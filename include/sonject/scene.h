/* A scene: sonar, water, seabed, objects, and where the image comes from. */
#ifndef SONJECT_SCENE_H
#define SONJECT_SCENE_H

#include <stddef.h>
#include <stdint.h>

#include <sonject/context.h>
#include <sonject/export.h>
#include <sonject/image.h>
#include <sonject/injection.h>
#include <sonject/medium.h>
#include <sonject/motion.h>
#include <sonject/object.h>
#include <sonject/pulse.h>
#include <sonject/relief.h>
#include <sonject/seabed.h>
#include <sonject/sonar.h>
#include <sonject/surface.h>
#include <sonject/user_shape.h>

SONJECT_BEGIN_DECLARATIONS

typedef struct sonject_scene sonject_scene;

/* Where the swath comes from. */
typedef enum sonject_input_kind {
    SONJECT_INPUT_MEMORY = 0,   /* the caller hands pixels to sonject_inject */
    SONJECT_INPUT_FILE = 1,     /* an image file */
    SONJECT_INPUT_UNIFORM = 2,  /* rows x columns of unit reflectivity */
    SONJECT_INPUT_SYNTHETIC = 3 /* made by sonject */
} sonject_input_kind;

/* Part of the swath that is worked on; all 0: the whole swath. */
typedef struct sonject_patch_params {
    uint32_t struct_size;
    uint32_t reserved;
    uint64_t first_row;
    uint64_t first_column;
    uint64_t rows;
    uint64_t columns;
} sonject_patch_params;

/* An empty scene with all defaults. On success *scene is the caller's, for sonject_scene_release;
 * on failure NULL. Errors: ARGUMENT, MEMORY. */
SONJECT_API sonject_status sonject_scene_create(sonject_context *context, sonject_scene **scene);

/* How a scene is read. All 0: the file as it is, without code. */
typedef struct sonject_scene_read_params {
    uint32_t struct_size;
    uint32_t allows_user_shapes; /* 1: take shapes that the scene, or a target's file that it names,
                                    describes by code; see sonject_user_shape_params. 0: refuse
                                    them, for such a file is a program */
    const char *text;            /* the scene instead of a file, YAML (which JSON is); copied */
    const char *const *overrides; /* override_count strings "key.path=value" that replace or add
                                     keys, such as "input.path=swath.tif" or
                                     "objects[0].heading=30 deg" */
    uint32_t override_count;
    uint32_t reserved; /* 0 */
} sonject_scene_read_params;

SONJECT_API void sonject_scene_read_params_init(sonject_scene_read_params *params);

/* Reads a scene file, or params->text. path: YAML file; of a text the name in messages, NULL for
 * "scene". Relative file names are resolved against path's folder, those of overrides against the
 * working directory. params may be NULL (all 0). A text may leave out where the image comes from,
 * for sonject_inject. Message on failure: file:line:column, the key, what is wrong. On success
 * *scene is the caller's, for sonject_scene_release; on failure NULL. Errors: ARGUMENT, INPUT,
 * STORAGE, UNSUPPORTED (a mesh's format), MEMORY. */
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
 * sonar.motion.yaw.file, medium.profile.file; and seabed.relief[N].heights.file, whose numbers are
 * those of an image's pixels, columns NULL. Keys beside it, such as sonar.pulse.kind, are set by
 * themselves. On failure the scene is unchanged. Errors: ARGUMENT, INPUT, MEMORY. */
SONJECT_API sonject_status sonject_scene_set_table(sonject_scene *scene, const char *key,
                                                   const char *columns, const double *values,
                                                   size_t row_count, size_t column_count);

/* The scene as text, with all that was set in its place: one that sonject_scene_read takes. Names
 * of files stand as they were given; a table in memory is not in it. *text is the caller's, for
 * sonject_text_release; on failure NULL. Errors: ARGUMENT (also a campaign's scene), MEMORY. */
SONJECT_API sonject_status sonject_scene_text(const sonject_scene *scene, char **text);

/* All keys that scenes have, as a JSON list of objects: path ("objects[].heading"), meaning, kind
 * (quantity, count, flag, word, text, file, section, list or special), unit, is_required, words
 * (null, or an array of them), and preset, least and most in the SI unit (null where there is
 * none). *json is the caller's, for sonject_text_release; on failure NULL. Errors: ARGUMENT,
 * MEMORY.
 */
SONJECT_API sonject_status sonject_keys(sonject_context *context, char **json);

/* sonject_scene_read with overrides apart. Errors: as there. */
SONJECT_API sonject_status sonject_scene_read_with(sonject_context *context, const char *path,
                                                   const char *const *overrides, size_t count,
                                                   const sonject_scene_read_params *params,
                                                   sonject_scene **scene);

/* The names of the bands that a scene file (section `bands`), with its overrides, leaves to be
 * chosen by an override such as "band=low": in the file's order, one a line, "" for a file without
 * bands or with one chosen. Of the scene nothing else is read. *names is the caller's, for
 * sonject_text_release. Errors: ARGUMENT, INPUT, STORAGE, MEMORY. */
SONJECT_API sonject_status sonject_scene_bands(sonject_context *context, const char *path,
                                               const char *const *overrides, size_t count,
                                               char **names);

/* Releases the scene and sets *scene to NULL; NULL allowed. */
SONJECT_API void sonject_scene_release(sonject_scene **scene);

/* Each call copies the structure, whose struct_size must be set (use the _init functions), and
 * checks it: on failure the scene is unchanged. Beyond the ranges stated at the members, lengths
 * and positions must be within 1000 km, lengths above 0 at least 1 um, and frequencies 1 Hz...1
 * GHz. Errors: ARGUMENT, INPUT (a value out of range), MEMORY. */
SONJECT_API sonject_status sonject_scene_set_sonar(sonject_scene *scene,
                                                   const sonject_sonar_params *sonar);
/* The kind TABLE needs the table first; GAUSSIAN and CHIRP take it away. */
SONJECT_API sonject_status sonject_scene_set_pulse(sonject_scene *scene,
                                                   const sonject_pulse_params *pulse);
/* Makes the pulse a table of complex baseband samples, copied: of the compressed envelope, phase
 * that of a target whose echo has phase 0. positions: count of them, 4...65536, rising through 0,
 * the target's own place; axis says what they are (sonject_pulse_axis). imaginary_part: NULL where
 * it is 0. All samples are divided by the largest one, so that G's peak is 1; between them G is
 * cubic (off by 0.2 % with four samples a resolution cell, 0.02 % with eight), outside 0. count 0:
 * the Gaussian pulse again. Errors: ARGUMENT, INPUT (what is wrong with which sample), MEMORY. */
SONJECT_API sonject_status sonject_scene_set_pulse_table(sonject_scene *scene, uint32_t axis,
                                                         const double *positions,
                                                         const double *real_part,
                                                         const double *imaginary_part,
                                                         size_t count);
/* The same along-track, at all ranges alike, in place of the sonar's window: W at distances in m
 * of the pixel beyond the target. Only for synthetic apertures without residual motion. count 0:
 * the window again. Errors: as above. */
SONJECT_API sonject_status sonject_scene_set_cross_range_table(sonject_scene *scene,
                                                               const double *distances_m,
                                                               const double *real_part,
                                                               const double *imaginary_part,
                                                               size_t count);
/* Residual motion of a synthetic aperture's sonar. */
SONJECT_API sonject_status sonject_scene_set_motion(sonject_scene *scene,
                                                    const sonject_motion_params *motion);
/* Adds measured sway (sonject_sway tells its sign) at positions along-track of the image, rising,
 * 2...65536 of them, copied; linear in between, constant beyond. count 0 takes it away. Errors:
 * ARGUMENT, INPUT, MEMORY. */
SONJECT_API sonject_status sonject_scene_set_motion_table(sonject_scene *scene,
                                                          const double *along_track_m,
                                                          const double *sway_m, size_t count);
/* The same for measured yaw, within 0.1 rad (sonject_motion_params tells its sign). It counts where
 * sonject_scene_set_motion gave the pings' advance; without that, runs are refused. */
SONJECT_API sonject_status sonject_scene_set_yaw_table(sonject_scene *scene,
                                                       const double *along_track_m,
                                                       const double *yaw_rad, size_t count);
SONJECT_API sonject_status sonject_scene_set_medium(sonject_scene *scene,
                                                    const sonject_medium_params *medium);
/* Replaces the water by level layers with refraction at the planes between them. bottoms_m: height
 * of each layer's lower edge over the mean seabed, count of them, the first 0, rising; the last
 * layer has no upper edge. sound_speeds_mps: 100...10000 each. densities: of the layers in any one
 * unit, above 0, NULL where they are equal; where they differ, planes also reflect (Rayleigh) and
 * what they transmit goes on. Up to 4096 layers; count 0: isovelocity water again. All is copied;
 * on failure the scene is unchanged. Errors: ARGUMENT, INPUT, MEMORY. */
SONJECT_API sonject_status sonject_scene_set_water_layers(sonject_scene *scene,
                                                          const double *bottoms_m,
                                                          const double *sound_speeds_mps,
                                                          const double *densities, size_t count);

/* The same for a measured profile: sound speeds at heights_m over the mean seabed, rising, at least
 * two, linear in between and constant beyond, turned into layers so thin that the sound speed
 * changes by at most 1/20000 from one to the next. Errors: ARGUMENT, INPUT (also: more layers than
 * 4096), MEMORY. */
SONJECT_API sonject_status sonject_scene_set_sound_speed_profile(sonject_scene *scene,
                                                                 const double *heights_m,
                                                                 const double *sound_speeds_mps,
                                                                 size_t count);

SONJECT_API sonject_status sonject_scene_set_seabed(sonject_scene *scene,
                                                    const sonject_seabed_params *seabed);
/* Gives the seabed heights over the mean plane (ripples, a mound, a pit), in m, rows x columns,
 * copied; they add to the relief of a scene file. relief->rows 0 takes them away (heights_m may
 * then be NULL). At the edges of the patch all relief falls to 0 over 1 m, or an eighth of the
 * patch's side where that is less. Slopes over 60 degrees, heights over half the altitude, a smooth
 * seabed and the coherent map are refused when the scene is used. Objects then rest on the height
 * under their origin. Errors: ARGUMENT, INPUT, MEMORY. */
SONJECT_API sonject_status sonject_scene_set_relief(sonject_scene *scene,
                                                    const sonject_relief_params *relief,
                                                    const float *heights_m);
/* depth 0 takes the surface away. That it lies above the sonar is checked when the scene is used.
 */
SONJECT_API sonject_status sonject_scene_set_surface(sonject_scene *scene,
                                                     const sonject_surface_params *surface);
SONJECT_API sonject_status sonject_scene_set_geometry(sonject_scene *scene,
                                                      const sonject_geometry_params *geometry);
SONJECT_API sonject_status sonject_scene_set_transfer(sonject_scene *scene,
                                                      const sonject_transfer_params *transfer);
SONJECT_API sonject_status sonject_scene_set_injection(sonject_scene *scene,
                                                       const sonject_injection_params *injection);
SONJECT_API sonject_status sonject_scene_set_patch(sonject_scene *scene,
                                                   const sonject_patch_params *patch);
/* An image (TIFF, PNG, JPEG, OpenEXR, PGM, PFM, BMP), an array (NumPy, HDF5, MATLAB) or an XTF
 * file. path is copied. */
SONJECT_API sonject_status sonject_scene_set_input_file(sonject_scene *scene, const char *path);
/* The channel of an input file that is XTF: 0...63, SONJECT_CHANNEL_PORT and the like; by default
 * SONJECT_CHANNEL_ONLY. Rows are pings, columns range cells from the track outwards on either side.
 * Errors: ARGUMENT (no such number). */
SONJECT_API sonject_status sonject_scene_set_input_channel(sonject_scene *scene, int32_t channel);
/* The name of the array in an input file that is HDF5 (its path there) or MATLAB, copied; NULL, as
 * by default: the only one of several rows and columns. Errors: ARGUMENT, MEMORY. */
SONJECT_API sonject_status sonject_scene_set_input_array(sonject_scene *scene, const char *array);
/* Sets the scene's geometry and the sonar's altitude from its input file. Of an XTF file row
 * spacing (straight line between positions) and altitude are means over the rows of the patch, to
 * be set before, and first_along_track_m stays; an image or HDF5 array tells what sonject_convert
 * or another call has kept in it. On failure the scene is unchanged. Errors: INPUT (the file does
 * not tell both, or is in ground range), STORAGE, MEMORY, UNSUPPORTED. */
SONJECT_API sonject_status sonject_scene_take_geometry(sonject_scene *scene);
SONJECT_API sonject_status sonject_scene_set_input_uniform(sonject_scene *scene, uint32_t rows,
                                                           uint32_t columns);
SONJECT_API sonject_status
sonject_scene_set_input_synthetic(sonject_scene *scene, const sonject_synthetic_params *synthetic);
/* Up to 250 objects; *index (may be NULL) gets the number of the new object, counted from 0. */
SONJECT_API sonject_status sonject_scene_add_object(sonject_scene *scene,
                                                    const sonject_object_params *object,
                                                    uint32_t *index);

/* Reads a mesh file (STL, OBJ, PLY) for objects of the shape
 * SONJECT_SHAPE_MESH, any number of which may show it: each call reads and keeps one (of scene
 * files, sonject_scene_read keeps one for all that name it alike). *mesh gets its number, counted
 * from 0. An object's centre is then the middle of the mesh's bounding box. Up to 64 meshes a
 * scene. Errors: ARGUMENT, STORAGE, INPUT (what is wrong and where), UNSUPPORTED (format), MEMORY.
 */
SONJECT_API sonject_status sonject_scene_add_mesh(sonject_scene *scene, const char *path,
                                                  const sonject_mesh_params *params,
                                                  uint32_t *mesh);

/* Takes a shape that the caller wrote in OpenCL C, for objects of the shape SONJECT_SHAPE_USER, any
 * number of which may show it. Code and name are copied; the call itself is the consent to run the
 * code. *user_shape gets its number, counted from 0. Several shapes may share one code with
 * different parameters: it is compiled once. Up to 1250 shapes and 64 different codes a scene. What
 * the compiler finds wrong is told ("name:line: what") when the scene is used, INPUT then. Errors:
 * ARGUMENT, INPUT (what is wrong and where), MEMORY. */
SONJECT_API sonject_status sonject_scene_add_user_shape(sonject_scene *scene,
                                                        const sonject_user_shape_params *shape,
                                                        uint32_t *user_shape);

/* Adds the target that a file describes (tools/targets holds such), as `target:` in a scene file
 * does; files that it names are meant from its own folder. Of `object`, NULL for a proud one in the
 * middle of the patch, position, pose, burial and level count, and name and class where they are
 * not ""; all else is the file's. params: whether the file may hold code; NULL: it may not. *index
 * (may be NULL) gets the object's number. On failure the scene is unchanged. Errors: ARGUMENT,
 * INPUT (what is wrong and where), STORAGE, UNSUPPORTED (a mesh's format), MEMORY. */
SONJECT_API sonject_status sonject_scene_add_target(sonject_scene *scene, const char *path,
                                                    const sonject_scene_read_params *params,
                                                    const sonject_object_params *object,
                                                    uint32_t *index);

/* Adds a part to an object of the shape SONJECT_SHAPE_PARTS. Of `shape`, the shape itself, its
 * sizes, ends, cuts and material count; its name, class, position, pose and burial do not. Parts
 * may overlap: they then are their union. Up to 1000 parts a scene. An object without parts is
 * refused when the scene is used. Errors: ARGUMENT (no such object), INPUT, MEMORY. */
SONJECT_API sonject_status sonject_scene_add_part(sonject_scene *scene, uint32_t object,
                                                  const sonject_object_params *shape,
                                                  const sonject_part_params *part);

SONJECT_API sonject_status sonject_scene_object_count(const sonject_scene *scene, uint32_t *count);

SONJECT_END_DECLARATIONS

#endif
