/* The sizes of an object in its own frame (x nose, z up when level, origin in the middle of its
 * overall sizes), its extents, and all else that differs between shapes. Each file of this folder
 * fills the row of its shape (kernels/shapes/shapes.h lists them). */
#ifndef SONJECT_SCENE_SHAPES_SHAPE_H
#define SONJECT_SCENE_SHAPES_SHAPE_H

#include <stdbool.h>
#include <stdint.h>

#include "scene/params.h"

#include "base/report.h"
#include "kernels/layout.h"
#include "mesh/mesh.h"
#include "scene/scene.h"

/* An end of a cylinder, counted outwards along the axis. */
struct end_size {
    double joint_m; /* end of the straight part */
    double depth_m; /* depth of the part of a sphere beyond the joint; 0: flat or open */
    bool is_open;
};

/* The sizes of a shape. The files in kernels/shapes say which of these a shape has. */
struct shape_size {
    double half_length_m; /* for a capsule, of the straight part */
    double half_width_m, half_height_m;
    double radius_m;      /* cones: at the bottom; torus: of the ring's middle line */
    double top_radius_m;  /* cones */
    double ring_radius_m; /* torus: of the ring's section */
    double front_height_m;
    struct end_size nose, tail;
    const struct mesh *mesh; /* the mesh of the shape mesh; borrowed from the scene */
    /* Radii of a sphere about the origin and of a cylinder about the nose that hold the shape. */
    double bounding_radius_m, radius_about_nose_m;
    /* The least radius of curvature, m, which sets the density of rays; INFINITY where nothing is
     * bent. Edges, tips, and a cone's part nearer to its axis than this do not count. */
    double least_radius_of_curvature_m;
    uint32_t flat; /* bits of enum flat_axis: its faces; 0 for a mesh, where they are not known */
};

/* The keys that describe a shape. */
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

/* The names of these keys, ended by a NULL. */
extern const struct shape_key_name {
    const char *key;
    uint32_t bit;
} shape_keys[];

/* The own axes that flat faces are perpendicular to. */
enum flat_axis {
    FLAT_ALONG_X = 1,
    FLAT_ALONG_Y = 2,
    FLAT_ALONG_Z = 4,
    FLAT_WITH_CORNERS = 8 /* faces with edges along the other two axes; else with rims */
};

/* The row of a shape. v: of any length. */
struct shape {
    uint32_t needs;    /* bits of enum shape_key */
    uint32_t may_have; /* bits of keys besides those */
    uint32_t flat;     /* bits of enum flat_axis: faces that it may have */
    /* Checks relations between its sizes; NULL: none. */
    void (*check)(struct check *check, const sonject_object_params *object);
    /* Sets sizes and radii. Sizes come in halved. Both bounding radii start at radius_m, the least
     * radius of curvature at INFINITY. NULL: all stay so. */
    void (*init)(struct shape_size *size, const sonject_object_params *object);
    /* Returns the largest p . v over its points p (its support function). */
    double (*extent)(const struct shape_size *size, const double v[3]);
    /* Sets the device's shape and values besides sizes; NULL: nothing to set. */
    void (*record)(struct object_record *record, const struct shape_size *size);
};

#define SHAPE_DECLARATION(NUMBER, name, traits) extern const struct shape shape_##name;
ALL_SHAPES(SHAPE_DECLARATION)

/* Returns the row of a shape by its number, enum shape_kind; NULL for an unknown one. */
const struct shape *shape_of(uint32_t shape);

/* Set the sizes of an object. The sizes of a mesh need the scene. */
void shape_size_init(struct shape_size *size, const sonject_object_params *object);
void shape_size_init_in_scene(struct shape_size *size, const struct scene *scene,
                              const sonject_object_params *object);

/* Sets the sizes of a mesh, which is borrowed. */
void shape_size_of_mesh(struct shape_size *size, const struct mesh *mesh);

/* Returns the largest p . v over a shape's points p (its support function), v of any length. */
double shape_extent(const struct shape_size *size, uint32_t shape, const double v[3]);

/* Returns whether no straight line from its surface outwards meets the surface again, as is_convex
 * in kernels/intersection.h. */
bool shape_is_convex(const struct shape_size *size, uint32_t shape);

/* Sets the shape and its sizes in a record. */
void shape_record_init(struct object_record *record, const struct shape_size *size, uint32_t shape);

/* Sets the slanting face of a record through two points of a profile, (across, up). The outward
 * normal points to the right of the way from the first to the second. */
void record_set_slant(struct object_record *record, double across, double up, double to_across,
                      double to_up);

/* Sets the radii of boxes and of shapes that lie within boxes. */
void shape_init_box(struct shape_size *size, const sonject_object_params *object);

/* Checks whether an object's sizes fit each other. */
void check_shape(struct check *check, const sonject_object_params *object);

#endif
