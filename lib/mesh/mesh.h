/* Triangle meshes, ready to be traced: their topology, the hierarchy that rays go through, and a
 * store of meshes that are kept. */
#ifndef SONJECT_MESH_MESH_H
#define SONJECT_MESH_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/file.h"
#include "mesh/hierarchy.h"

/* The meaning of a file's numbers. */
struct mesh_options {
    double unit_m; /* m in a unit of the file, > 0; default 1 */
    /* The axes of the file that are the object's x (nose), y and z axis: 1, 2, 3; negative: the
     * reverse of it. Together they are a rotation, not a mirror. Default 1, 2, 3. A file whose y
     * axis is up and whose nose is x has 1, -3, 2. */
    int axes[3];
    double smooth_angle_rad; /* facets that meet at a smaller angle stand for one smooth surface; 0
                                (default): all facets are flat */
};

/* The connections between triangles. */
struct mesh_topology {
    size_t open_edges;    /* edges of one triangle */
    size_t crowded_edges; /* edges of three triangles or more */
    size_t twisted_edges; /* edges of two triangles that cannot both show the same side (Moebius) */
    size_t turned;        /* triangles whose orientation was reversed */
    size_t pieces;        /* sets of triangles that are connected by edges of two */
    bool is_closed;       /* every edge belongs to two triangles, which run oppositely along it */
    uint32_t edge[2];     /* vertices of one edge that keeps it from being closed */
    double volume;        /* enclosed volume, m3, of a closed mesh; else 0 */
};

struct mesh {
    /* Positions in the mesh's frame: the object's axes, m, about centre_m. */
    float *vertices; /* vertex_count x 3; owned */
    uint32_t
        *corners; /* triangle_count x 3: numbers of vertices, anticlockwise from outside; owned */
    size_t vertex_count, triangle_count;

    double
        centre_m[3]; /* middle of the bounding box, from the file's origin in the object's axes */
    float lower_m[3], upper_m[3]; /* the bounding box in the mesh's frame */
    float radius_m;               /* radius of the bounding sphere about the frame's origin */
    struct mesh_topology topology;
    size_t welded;     /* vertices of seams that lay apart by less than the tolerance */
    size_t degenerate; /* triangles of the file with two equal corners, which were left out */

    struct mesh_hierarchy hierarchy;
    char *name;                          /* name of its file; owned */
    struct path_facts file;              /* facts of the file before it was read */
    struct mesh_options options;         /* options that it was read with */
    struct mesh_corner_normals *normals; /* hierarchy.leaf_count * MESH_SLOTS; NULL: flat; owned */
};

void mesh_options_init(struct mesh_options *options);

/* Returns whether a mesh read with these options from that file would be this one. */
bool mesh_is_of(const struct mesh *mesh, const struct path_facts *file,
                const struct mesh_options *options);

/* Reads a mesh file: STL, OBJ, PLY. Equal vertices become one, after rounding to single precision
 * in the mesh's frame. If the mesh is then open, vertices closer than a millionth of its bounding
 * box's diagonal become one, too. Triangles with two equal corners are left out, and orientation is
 * made consistent. A mesh that is not closed is no failure here: topology says what is open.
 * Errors: STORAGE (cannot be read), INPUT (what and where), UNSUPPORTED (format), MEMORY. On
 * failure *mesh is empty. */
sonject_status mesh_load(struct report *report, const char *path,
                         const struct mesh_options *options, struct mesh *mesh);

void mesh_clear(struct mesh *mesh);

/* Returns SONJECT_OK if the mesh is closed. Errors: INPUT (the message tells what is open). */
sonject_status mesh_require_closed(struct report *report, const char *name,
                                   const struct mesh *mesh);

/* Returns the record of a mesh whose elements begin at these places of the arrays of all meshes. */
struct mesh_record mesh_record_of(const struct mesh *mesh, uint32_t first_branch,
                                  uint32_t first_leaf, uint32_t first_normals);

/* Finds the topology and orients the triangles by swapping second and third corners. Neighbours are
 * oriented alike. A piece with triangles to turn faces outward, and so does each closed piece that
 * no other holds. What it holds turns with it, so a cavity stays one. vertices: triples of
 * coordinates. corners: three a triangle, none equal. Errors: MEMORY. */
sonject_status mesh_topology_find(struct report *report, const float *vertices, size_t vertex_count,
                                  uint32_t *corners, size_t triangle_count,
                                  struct mesh_topology *topology);

/* Finds one unit normal a corner, 3 * triangles of 3 numbers, which the caller frees. The normal is
 * the mean of the facets around the vertex that lie within `angle` rad of the corner's own facet.
 * Facets weigh by the angles that they span there. Larger angles between facets are edges. A corner
 * of a facet without area, or at a vertex of more than 256 facets, has its facet's normal, which is
 * 0 0 0 without area. Errors: MEMORY. */
sonject_status mesh_smooth_normals(struct report *report, const float *vertices,
                                   size_t vertex_count, const uint32_t *corners,
                                   size_t triangle_count, double angle, float **normals);

#define MESH_STORE_MESHES 256

/* Meshes that are kept from scene to scene, so that their files are not read each time. A store
 * starts as zeros, and ends with mesh_store_clear. Only one thread may use it at a time. */
struct mesh_store {
    struct mesh meshes[MESH_STORE_MESHES]; /* owned; the last is the one that was given last */
    size_t count;
    uint64_t bytes; /* size of all meshes */
};

/* Moves a mesh of that file, as it now is, with those options out of the store into *mesh. Does
 * nothing and returns false if there is none. */
bool mesh_store_take(struct mesh_store *store, const struct path_facts *file,
                     const struct mesh_options *options, struct mesh *mesh);

/* Moves a mesh into the store, and leaves *mesh empty. A full store drops its oldest meshes. */
void mesh_store_give(struct mesh_store *store, struct mesh *mesh);
void mesh_store_clear(struct mesh_store *store);

#endif
