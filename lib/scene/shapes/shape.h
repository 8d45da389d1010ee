/* The sizes of an object in its own frame (x nose, z up when level, origin in the middle of its
 * overall sizes), how far it reaches, and what else differs from shape to shape: a file of this
 * folder fills a row for its shape (kernels/shapes/shapes.h lists them). */
#ifndef SONJECT_SCENE_SHAPES_SHAPE_H
#define SONJECT_SCENE_SHAPES_SHAPE_H

#include <stdbool.h>
#include <stdint.h>

#include "scene/params.h"

#include "base/report.h"
#include "kernels/layout.h"
#include "mesh/mesh.h"
#include "scene/scene.h"

/* Counted outwards along the axis. */
struct end_size {
    double joint_m; /* where the straight part ends */
    double depth_m; /* of the part of a sphere beyond it; 0: flat or open */
    bool is_open;
};

/* Which of them a shape has, the files in kernels/shapes say. */
struct shape_size {
    double half_length_m; /* of the straight part for a capsule */
    double half_width_m, half_height_m;
    double radius_m;      /* cones: below; torus: of the ring's middle line */
    double top_radius_m;  /* cones */
    double ring_radius_m; /* torus: of the ring's section */
    double front_height_m;
    struct end_size nose, tail;
    const struct mesh *mesh; /* of a mesh; borrowed from the scene */
    /* Radii of a sphere about the origin and of a cylinder about the nose axis that hold it. */
    double bounding_radius_m, radius_about_nose_m;
    /* m; INFINITY where nothing is bent. Edges and tips do not count, nor what of a cone is nearer
     * to its axis than this. It decides how dense the rays on it are. */
    double least_radius_of_curvature_m;
    uint32_t flat; /* bits of enum flat_axis: faces that it has; of a mesh not known: 0 */
};

/* Keys that say what a shape is. */
enum shape_key {
    SHAPE_HAS_LENGTH = 1,
    SHAPE_HAS_WIDTH = 2,
    SHAPE_HAS_DIAMETER = 4,
    SHAPE_HAS_HEIGHT = 8,
    SHAPE_HAS_TOP_DIAMETER = 16,
    SHAPE_HAS_FRONT_HEIGHT = 32,
    SHAPE_HAS_ENDS = 64,
    SHAPE_HAS_MESH = 128
};

/* Their names, up to a NULL. */
extern const struct shape_key_name {
    const char *key;
    uint32_t bit;
} shape_keys[];

/* Own axes that flat faces stand across. */
enum flat_axis {
    FLAT_ALONG_X = 1,
    FLAT_ALONG_Y = 2,
    FLAT_ALONG_Z = 4,
    FLAT_WITH_CORNERS = 8 /* edges along the other two axes; else rims */
};

/* What a shape is. v: of any length. */
struct shape {
    uint32_t needs;    /* bits of enum shape_key */
    uint32_t may_have; /* besides those */
    uint32_t flat;     /* bits of enum flat_axis: faces that it may have */
    /* Relations between its sizes; NULL: none. */
    void (*check)(struct check *check, const sonject_object_params *object);
    /* Sizes and radii. Sizes come in halved; both bounding radii start at radius_m, the least
     * radius of curvature at INFINITY. NULL: they stay so. */
    void (*init)(struct shape_size *size, const sonject_object_params *object);
    /* The largest p . v over its points p (its support function). */
    double (*extent)(const struct shape_size *size, const double v[3]);
    /* What the device is told besides sizes, and as which shape; NULL: nothing. */
    void (*record)(struct object_record *record, const struct shape_size *size);
};

#define SHAPE_DECLARATION(NUMBER, name, traits) extern const struct shape shape_##name;
ALL_SHAPES(SHAPE_DECLARATION)

/* By its number, enum shape_kind; NULL for an unknown one. */
const struct shape *shape_of(uint32_t shape);

/* The sizes of an object; those of a mesh are not known without the scene. */
void shape_size_init(struct shape_size *size, const sonject_object_params *object);
void shape_size_init_in_scene(struct shape_size *size, const struct scene *scene,
                              const sonject_object_params *object);

/* What is borrowed. */
void shape_size_of_mesh(struct shape_size *size, const struct mesh *mesh);

/* The largest p . v over the points p of a shape (its support function), v of any length. */
double shape_extent(const struct shape_size *size, uint32_t shape, const double v[3]);

/* Whether no straight line from its surface outwards meets it again, as is_convex in
 * kernels/intersection.h. */
bool shape_is_convex(const struct shape_size *size, uint32_t shape);

/* The shape and its sizes in a record. */
void shape_record_init(struct object_record *record, const struct shape_size *size, uint32_t shape);

/* The slanting face of a record through two points of a profile, (across, up), seen from the left
 * of the way between. */
void record_set_slant(struct object_record *record, double across, double up, double to_across,
                      double to_up);

/* The radii of boxes and of what lies in them. */
void shape_init_box(struct shape_size *size, const sonject_object_params *object);

/* Whether an object's sizes fit each other. */
void check_shape(struct check *check, const sonject_object_params *object);

#endif
