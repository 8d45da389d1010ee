/* The sizes of an object in its own frame (x nose, z up when level, origin in the middle of its
 * overall sizes), and how far it reaches. */
#ifndef SONJECT_SCENE_SHAPE_SIZE_H
#define SONJECT_SCENE_SHAPE_SIZE_H

#include <stdbool.h>
#include <stdint.h>

#include <sonject/object.h>

#include "mesh/mesh.h"
#include "scene/user_shapes.h"

/* Counted outwards along the axis. */
struct end_size {
    double joint_m; /* where the straight part ends */
    double depth_m; /* of the part of a sphere beyond it; 0: flat or open */
    bool is_open;
};

struct cut_plane {
    double normal[3]; /* unit, outward */
    double offset_m;  /* of the plane from the origin along it */
};

/* Which of them a shape has, the members of struct object_record in kernels/layout.h say. */
struct shape_size {
    double half_length_m; /* of the straight part for a capsule */
    double half_width_m, half_height_m;
    double radius_m;      /* cones: below; torus: of the ring's middle line */
    double top_radius_m;  /* cones */
    double ring_radius_m; /* torus: of the ring's section */
    double front_height_m;
    struct end_size nose, tail;
    struct cut_plane cuts[SONJECT_CUTS_CAPACITY];
    uint32_t cut_count;
    const struct mesh *mesh;             /* of a mesh; borrowed from the scene */
    const struct user_shape *user_shape; /* likewise */
    double bounding_radius_m;            /* about the origin, of the uncut shape */
};

/* A mesh's sizes come from shape_size_of_mesh. */
void shape_size_init(struct shape_size *size, const sonject_object_params *object);

/* mesh is borrowed. */
void shape_size_of_mesh(struct shape_size *size, const struct mesh *mesh);

/* shape is borrowed. */
void shape_size_of_user_shape(struct shape_size *size, const struct user_shape *shape);

/* The largest p . v over the points p of what the cuts leave of a shape (its support function), v
 * of any length; -INFINITY where they leave nothing. Exact but for cut tubes, which it takes as
 * filled, and for user shapes, of which only a box and a sphere about them are known: the lesser of
 * what the cuts leave of these. */
double shape_extent(const struct shape_size *size, uint32_t shape, const double v[3]);

/* Whether the cuts leave something. */
bool shape_is_left(const struct shape_size *size, uint32_t shape);

/* Radius about the nose axis that holds the uncut shape. */
double shape_radius_about_nose(const struct shape_size *size, uint32_t shape);

#endif
