/* A scene as the library keeps it: complete structures of parameters. Pure data. */
#ifndef SONJECT_SCENE_SCENE_H
#define SONJECT_SCENE_SCENE_H

#include <stdbool.h>
#include <stdint.h>

#include <sonject/elements.h>

#include "base/hash.h"
#include "base/report.h"
#include "medium/water.h"
#include "mesh/mesh.h"
#include "scene/aperture_motion.h"
#include "scene/geometry.h"
#include "scene/params.h"
#include "scene/relief_features.h"
#include "scene/response_table.h"

#define SCENE_OBJECTS_MAX      250 /* ids must fit the 8-bit label image */
#define SCENE_PARTS_MAX        1000
#define SCENE_SHAPES_MAX       1024 /* parts, and objects of one shape; at most STREAMS_OF_PAIR */
#define SCENE_MESHES_MAX       64
#define SCENE_INTERACTIONS_MAX 8
#define SWATH_PIXELS_MAX       (UINT64_C(1) << 31)

/* The place of each key of a scene in its file, for mistakes that show only when the image and its
 * geometry are known. */
struct written_keys {
    struct written_key {
        char *path;  /* owned: "objects[0].position" */
        char *place; /* within path's memory: "scene.yaml:12:5", "--set objects[0].position" */
    } * keys;        /* owned */
    size_t count;
};

/* A part of an object of parts. */
struct scene_part {
    uint32_t object;
    sonject_object_params shape; /* sizes and material of the part */
    double axes[3][3];           /* rows: nose, own y, own z, in the object's own axes */
    double centre[3];            /* m, in the object's own frame */
};

struct scene {
    sonject_sonar_params sonar;
    sonject_pulse_params pulse;
    struct response_table pulse_table;       /* for the kind TABLE */
    struct response_table cross_range_table; /* a measured W; count 0: the sonar's window */
    struct aperture_motion motion;
    sonject_medium_params medium;
    struct water_layer *water_layers; /* owned; NULL: isovelocity water at medium's sound speed */
    size_t water_layer_count;
    sonject_seabed_params seabed;
    sonject_surface_params surface;
    sonject_geometry_params geometry;
    sonject_transfer_params transfer;
    sonject_injection_params injection;
    sonject_elements_params elements;
    sonject_patch_params patch;
    sonject_input_kind input_kind;
    char *input_path;         /* owned; NULL unless input_kind is SONJECT_INPUT_FILE */
    struct ping_table pings;  /* values of the input's rows, from a table */
    char *calibration;        /* owned; the file that input.calibration names; NULL: none */
    char *calibrated;         /* owned; the keys taken from that file, one per line; NULL: none */
    char calibrated_side[12]; /* side of the calibration's image, as keys name it; "": not given */
    char calibrated_hash[HASH_TEXT_CAPACITY]; /* of the calibration's image; "": not given */
    bool calibrated_leftward; /* range grows to the left in the calibration's image of one side */
    double recorded_over_first_return; /* median of recorded altitudes over first returns; 0: not
                                          given */
    struct first_return_list first_returns; /* the whole swath's, from the calibration */
    bool calibrates_itself;  /* auto: whoever runs the scene makes the calibration first */
    bool has_files_geometry; /* the input file gives some geometry, here for the patch's rows */
    bool has_pings_range;    /* `pings` gives the first slant range, for the patch's rows */
    enum altitude_source altitude_by;
    double altitudes_m[2]; /* lowest and highest altitude of a whole line's pings, whose mean is
                              taken; 0: all are alike, or a patch is chosen */
    bool input_is_complex; /* two channels of the file are real and imaginary part */
    int32_t channel; /* channel of a recording: SONJECT_CHANNEL_PORT and the like, or a number */
    char *array;     /* owned; name of one array of several in a file; NULL: the only one */
    char *band;      /* owned; the chosen band of its file; NULL: no bands */
    char *bands;     /* owned; names of all bands, one per line; NULL: no bands */
    uint32_t uniform_rows, uniform_columns;
    sonject_synthetic_params synthetic;
    sonject_object_params *objects; /* owned */
    uint32_t object_count;
    struct mesh *meshes; /* owned */
    uint32_t mesh_count;
    struct mesh_store *mesh_store; /* source of meshes, which go back to it; borrowed; NULL: none */
    struct scene_part *parts;      /* owned; in no order */
    uint32_t part_count;
    struct relief_features relief;
    struct written_keys written; /* none where no file was read */
};

/* Set all defaults, from the tables of keys (lib/schema, which defines these two functions).
 * geometry.first_slant_range_m has none and is NaN. Objects begin as a sphere without size. */
void scene_init(struct scene *scene);
void object_init(sonject_object_params *object);

/* Frees the memory that the scene owns, and makes the scene all zeros, ready for scene_init. */
void scene_clear(struct scene *scene);

/* Appends a copy, with the default name and class where it has none. There must be fewer than
 * SCENE_OBJECTS_MAX objects. Errors: MEMORY. */
sonject_status scene_append_object(struct scene *scene, struct report *report,
                                   const sonject_object_params *object);

/* Appends a copy. There must be fewer than SCENE_PARTS_MAX parts. Errors: MEMORY. */
sonject_status scene_append_part(struct scene *scene, struct report *report,
                                 const struct scene_part *part);

/* Notes the place of a key whose section has been noted before. Errors: MEMORY. */
sonject_status scene_note_key(struct scene *scene, struct report *report, const char *path,
                              const char *place);

/* Returns the source of a key's value, a sonject_source: default, scene or calibration. */
uint32_t scene_key_source(const struct scene *scene, const char *path);

/* Finds the number of the mesh that the scene has from that file, as the file is now, with those
 * options. If there is none, reads and appends it. Errors: as for mesh_load; INPUT also for an open
 * mesh or too many meshes. */
sonject_status scene_share_mesh(struct scene *scene, struct report *report, const char *path,
                                const struct mesh_options *options, bool allows_open,
                                uint32_t *number);

/* Puts a place in front of the report's message: that of the key that path (a format) names in the
 * scene's file, or of the nearest section around it. Returns status. The message stays the same
 * where status is not INPUT or the file has no such key. */
sonject_status scene_locate(const struct scene *scene, struct report *report, sonject_status status,
                            const char *path, ...) REPORT_FORMAT(4);

/* Returns the name of a shape as scene files write it; NULL for an unknown shape. */
const char *shape_name(uint32_t shape);

#endif
