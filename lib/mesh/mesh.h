/* Triangle meshes, ready to be traced: how their triangles hang together, the hierarchy that rays
 * go through, and a store of those that are kept. */
#ifndef SONJECT_MESH_MESH_H
#define SONJECT_MESH_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/file.h"
#include "mesh/hierarchy.h"

/* How a file's numbers are meant. */
struct mesh_options {
    double unit_m; /* m a unit of the file, > 0; default 1 */
    /* Which axis of the file the object's x (nose), y and z axis is: 1, 2, 3, negative: the reverse
     * of it. Together a rotation, not a mirror. Default 1, 2, 3; a file whose y axis is up and
     * whose nose is x: 1, -3, 2. */
    int axes[3];
    double smooth_angle_rad; /* facets that meet at less stand for one smooth surface; 0 (default):
                                all facets are flat */
};

/* How triangles hang together. */
struct mesh_topology {
    size_t open_edges;    /* of one triangle */
    size_t crowded_edges; /* of three or more */
    size_t twisted_edges; /* of two triangles that cannot both show the same side (Moebius) */
    size_t turned;        /* triangles whose orientation was reversed */
    size_t pieces;        /* sets of triangles that hang together by edges of two */
    bool is_closed;       /* every edge is that of two triangles, run in opposite directions */
    uint32_t edge[2];     /* vertices of one edge that keeps it from being closed */
    double volume;        /* enclosed, m3; of a closed mesh only, else 0 */
};

struct mesh {
    /* In the object's axes, m, about `centre`: the mesh's frame. */
    float *vertices; /* vertex_count x 3; owned */
    uint32_t
        *corners; /* triangle_count x 3: numbers of vertices, anticlockwise from outside; owned */
    size_t vertex_count, triangle_count;

    double centre_m[3]; /* middle of the bounding box, in the file's origin and the object's axes */
    float lower_m[3], upper_m[3]; /* the bounding box in the mesh's frame */
    float radius_m;               /* of the bounding sphere about the frame's origin */
    struct mesh_topology topology;
    size_t welded;     /* vertices of seams that were off by less than the tolerance */
    size_t degenerate; /* triangles of the file with two equal corners, which were left out */

    struct mesh_hierarchy hierarchy;
    char *name;                          /* of its file; owned */
    struct path_facts file;              /* as it was before it was read */
    struct mesh_options options;         /* that it was read with */
    struct mesh_corner_normals *normals; /* hierarchy.leaf_count * MESH_SLOTS; NULL: flat; owned */
};

void mesh_options_init(struct mesh_options *options);

/* Whether a mesh read with these options from that file would be this one. */
bool mesh_is_of(const struct mesh *mesh, const struct path_facts *file,
                const struct mesh_options *options);

/* Reads a mesh file: STL, OBJ, PLY. Equal vertices become one (after rounding to single precision
 * in the mesh's frame); where that leaves the mesh open, so do those that are closer than a
 * millionth of its bounding box's diagonal. Triangles with two equal corners are left out,
 * orientation is made consistent. A mesh that is not closed is no failure here: topology says what
 * is open. Errors: STORAGE (cannot be read), INPUT (what and where), UNSUPPORTED (format), MEMORY.
 * On failure *mesh is empty. */
sonject_status mesh_load(struct report *report, const char *path,
                         const struct mesh_options *options, struct mesh *mesh);

void mesh_clear(struct mesh *mesh);

/* SONJECT_OK if the mesh is closed; else INPUT with a message that says what is open and where. */
sonject_status mesh_require_closed(struct report *report, const char *name,
                                   const struct mesh *mesh);

/* The record of a mesh whose elements begin at these places of the arrays of all meshes. */
struct mesh_record mesh_record_of(const struct mesh *mesh, uint32_t first_branch,
                                  uint32_t first_leaf, uint32_t first_normals);

/* Finds the topology, and orients the triangles (their second and third corners are swapped where
 * needed): neighbours alike; a piece that needed it outward; a mesh whose pieces all were
 * consistent but whose volume is negative, as a whole. So a cavity that its file orients inward
 * stays one. vertices: triples of coordinates; corners: three a triangle, none equal. Errors:
 * MEMORY. */
sonject_status mesh_topology_find(struct report *report, const float *vertices, size_t vertex_count,
                                  uint32_t *corners, size_t triangle_count,
                                  struct mesh_topology *topology);

/* One unit normal a corner (3 * triangles, 3 numbers each; to be given to free()): the mean of the
 * facets around the corner's vertex that lie within `angle` rad of the corner's own facet, weighted
 * by the angles that they span there. Larger angles between facets are edges. A corner of a facet
 * without area, or at a vertex of more than 256 facets, has its facet's normal (0 0 0 for a facet
 * without area). Errors: MEMORY. */
sonject_status mesh_smooth_normals(struct report *report, const float *vertices,
                                   size_t vertex_count, const uint32_t *corners,
                                   size_t triangle_count, double angle, float **normals);

#define MESH_STORE_MESHES 256

/* Meshes that are kept from scene to scene, so that their files are not read each time.
 * Starts as all zeros, is for mesh_store_clear. One thread at a time. */
struct mesh_store {
    struct mesh meshes[MESH_STORE_MESHES]; /* owned; the one that was given last is the last */
    size_t count;
    uint64_t bytes; /* of all */
};

/* Moves a mesh of that file, as it now is, with those options out of the store into *mesh. False,
 * with nothing done, if there is none. */
bool mesh_store_take(struct mesh_store *store, const struct path_facts *file,
                     const struct mesh_options *options, struct mesh *mesh);

/* Moves a mesh into the store, which drops the oldest where it is full. *mesh is empty then. */
void mesh_store_give(struct mesh_store *store, struct mesh *mesh);
void mesh_store_clear(struct mesh_store *store);

#endif
