/* The bounding-volume hierarchy (BVH) of a mesh: boxes tell which triangles a ray may meet. Sets of
 * boxes are cut in two so that rays have least to test. */
#ifndef SONJECT_MESH_HIERARCHY_H
#define SONJECT_MESH_HIERARCHY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"
#include "mesh_records.h"

/* The most triangles of one mesh. The numbers of the slots that they fill stay below 2^31. */
#define MESH_TRIANGLES_MAX ((size_t)1 << 26)

/* The mark of a leaf's slot that holds no triangle. */
#define MESH_NO_TRIANGLE UINT32_MAX

struct mesh_hierarchy {
    struct mesh_branch *branches; /* branch_count, the root first; owned */
    struct mesh_leaf *leaves;     /* leaf_count; owned */
    size_t branch_count, leaf_count;
    uint32_t *triangles; /* leaf_count x MESH_SLOTS: number of the triangle in each slot, or
                            MESH_NO_TRIANGLE; owned */
    uint32_t levels;     /* branches on the longest way from the root to a leaf, 1...MESH_LEVELS */
};

/* Builds the hierarchy of count triangles (1...MESH_TRIANGLES_MAX) by the surface-area heuristic
 * over bins of the triangles' middles (Wald 2007). Equal triangles give equal hierarchies
 * everywhere. vertices: triples of finite coordinates, m. corners: three numbers of vertices a
 * triangle. radius: m, about the origin, holds all vertices. Errors: MEMORY; then *hierarchy is
 * empty. */
sonject_status mesh_hierarchy_build(struct report *report, const float *vertices,
                                    const uint32_t *corners, size_t count, float radius,
                                    struct mesh_hierarchy *hierarchy);
void mesh_hierarchy_clear(struct mesh_hierarchy *hierarchy);

/* Makes room for one more element of `size` bytes in an array; returns false if memory lacks. */
bool mesh_reserve(void **array, size_t count, size_t *capacity, size_t size);

/* A box as its lower corner (0...2) and the negative of its upper one (4...6): one minimum of all
 * eight numbers unites two boxes. Numbers 3 and 7 are unused and 0. */
struct split_box {
    float edges[8];
};

/* A triangle's box and number. */
struct split_item {
    struct split_box box;
    uint32_t number;
};

/* The triangles [first, last) of an array. */
struct split_range {
    size_t first, last;
    struct split_box box; /* holds the triangles */
};

void split_box_unite(struct split_box *box, const struct split_box *other);
struct split_box split_box_empty(void);

/* Writes a box, its faces moved outwards, into a slot of rows of faces. */
#define SPLIT_BOX_STORE(box, padding, faces, slot)                                                 \
    do {                                                                                           \
        for (size_t axis = 0; axis < 3; axis++) {                                                  \
            (faces)[axis][slot] = (box)->edges[axis] - (padding);                                  \
            (faces)[axis + 3][slot] = -(box)->edges[axis + 4] + (padding);                         \
        }                                                                                          \
    } while (0)

/* Returns half the surface; 0 for an empty box. */
float split_box_area(const struct split_box *box);

/* Returns the box of all triangles of the range. */
struct split_box split_box_of(const struct split_item *triangles, size_t first, size_t last);

/* Cuts the range (2 triangles or more) in two where the surface-area heuristic says, and rearranges
 * its triangles. Cuts at the median where the heuristic gives a half of more than half_limit, or
 * all middles are the same. */
void split_cut(struct split_item *triangles, const struct split_range *range, size_t half_limit,
               struct split_range *lower, struct split_range *upper);

/* Cuts the range behind its first lower_count triangles (1...count - 1) by their middles along the
 * box's longest axis. */
void split_cut_at(struct split_item *triangles, const struct split_range *range, size_t lower_count,
                  struct split_range *lower, struct split_range *upper);

#endif
