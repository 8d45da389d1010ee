/* A scene as the library keeps it: the public parameter structures themselves, each complete (no
 * zero sizes, no defaults left open). Pure data. */
#ifndef SONJECT_SCENE_SCENE_H
#define SONJECT_SCENE_SCENE_H

#include <stdbool.h>
#include <stdint.h>

#include <sonject/elements.h>

#include "base/report.h"
#include "medium/water.h"
#include "mesh/mesh.h"
#include "scene/aperture_motion.h"
#include "scene/params.h"
#include "scene/relief_features.h"
#include "scene/response_table.h"
#include "scene/user_shapes.h"
#include "scene/written.h"

#define SCENE_OBJECTS_MAX      250 /* ids must fit the 8-bit label image */
#define SCENE_PARTS_MAX        1000
#define SCENE_SHAPES_MAX       1024 /* parts and objects of one shape: STREAMS_OF_PAIR */
#define SCENE_MESHES_MAX       64
#define SCENE_INTERACTIONS_MAX 8

/* A part of an object of parts. */
struct scene_part {
    uint32_t object;
    sonject_object_params shape; /* its sizes and material */
    double axes[3][3];           /* rows: nose, own y, own z, in the object's own axes */
    double centre[3];            /* m, in the object's own frame */
};

struct scene {
    sonject_sonar_params sonar;
    sonject_pulse_params pulse;
    struct response_table pulse_table;       /* of the kind TABLE */
    struct response_table cross_range_table; /* of a measured W; count 0: the sonar's window */
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
    char *input_path;           /* owned; NULL unless input_kind is SONJECT_INPUT_FILE */
    bool has_recorded_altitude; /* the input file says it, ping by ping */
    bool input_is_complex;      /* two channels of the file are real and imaginary part */
    int32_t channel; /* of a file that is XTF: SONJECT_CHANNEL_PORT and the like, or a number */
    char *array;     /* owned; of several in a file, its name; NULL: the only one */
    char *band;      /* owned; which of its file's bands it is; NULL: that has none */
    char *bands;     /* owned; all their names, one a line; NULL likewise */
    uint32_t uniform_rows, uniform_columns;
    sonject_synthetic_params synthetic;
    sonject_object_params *objects; /* owned */
    uint32_t object_count;
    struct mesh *meshes; /* owned */
    uint32_t mesh_count;
    struct mesh_store *mesh_store; /* that meshes come from and go back to; borrowed; NULL: none */
    struct user_shapes user_shapes;
    struct scene_part *parts; /* owned; in no order */
    uint32_t part_count;
    struct relief_features relief;
    struct written_keys written; /* none where no file was read */
};

/* All defaults, which the table of keys holds (lib/schema, which defines it and the checks below);
 * geometry.first_slant_range_m has none and is NaN, which check_geometry refuses. */
void scene_init(struct scene *scene);

/* Frees what the scene owns and makes it all zeros, for scene_init or nothing more. */
void scene_clear(struct scene *scene);

/* Appends a copy, with the name and class that it has by default where it has none. Errors: INPUT
 * (too many), MEMORY. */
sonject_status scene_append_object(struct scene *scene, struct report *report,
                                   const sonject_object_params *object);

/* Appends a copy. Errors: INPUT (too many), MEMORY. */
sonject_status scene_append_part(struct scene *scene, struct report *report,
                                 const struct scene_part *part);

/* The number of the mesh that the scene already has from that file, as it now is, with those
 * options; else reads and appends it. Errors: as mesh_load, INPUT also where it is open or there
 * are too many. */
sonject_status scene_share_mesh(struct scene *scene, struct report *report, const char *path,
                                const struct mesh_options *options, bool allows_open,
                                uint32_t *number);

/* Checks of one structure each, ranges and relations as the public headers state them. The message
 * starts with the name of the value as the scene file writes it ("bandwidth must be ..."). report
 * keeps the first failure, listener hears all; either may be NULL. Errors: INPUT. */
sonject_status check_sonar(const sonject_sonar_params *sonar, struct report *report,
                           struct check_listener *listener);
sonject_status check_pulse(const sonject_pulse_params *pulse, struct report *report,
                           struct check_listener *listener);
sonject_status check_motion(const sonject_motion_params *motion, struct report *report,
                            struct check_listener *listener);
sonject_status check_medium(const sonject_medium_params *medium, struct report *report,
                            struct check_listener *listener);
sonject_status check_seabed(const sonject_seabed_params *seabed, struct report *report,
                            struct check_listener *listener);
sonject_status check_surface(const sonject_surface_params *surface, struct report *report,
                             struct check_listener *listener);
sonject_status check_geometry(const sonject_geometry_params *geometry, struct report *report,
                              struct check_listener *listener);
sonject_status check_transfer(const sonject_transfer_params *transfer, struct report *report,
                              struct check_listener *listener);
sonject_status check_injection(const sonject_injection_params *injection, struct report *report,
                               struct check_listener *listener);
sonject_status check_elements(const sonject_elements_params *elements, struct report *report,
                              struct check_listener *listener);
sonject_status check_patch(const sonject_patch_params *patch, struct report *report,
                           struct check_listener *listener);
sonject_status check_uniform(uint32_t rows, uint32_t columns, struct report *report,
                             struct check_listener *listener);
sonject_status check_synthetic(const sonject_synthetic_params *synthetic, struct report *report,
                               struct check_listener *listener);
sonject_status check_part(const sonject_part_params *part, struct report *report,
                          struct check_listener *listener);
sonject_status check_object(const sonject_object_params *object, struct report *report,
                            struct check_listener *listener);

/* The name of a shape as scene files write it; NULL for an unknown one. */
const char *shape_name(uint32_t shape);

#endif
