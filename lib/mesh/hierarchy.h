/* The bounding-volume hierarchy of a mesh: which triangles a ray may meet, found by boxes. */
#ifndef SONJECT_MESH_HIERARCHY_H
#define SONJECT_MESH_HIERARCHY_H

#include <stddef.h>
#include <stdint.h>

#include "base/report.h"
#include "mesh_records.h"

/* Most triangles of one mesh: the numbers of the slots that they fill stay below 2^31. */
#define MESH_TRIANGLES_MAX ((size_t)1 << 26)

/* A slot of a leaf that holds no triangle. */
#define MESH_NO_TRIANGLE UINT32_MAX

struct mesh_hierarchy {
    struct mesh_branch *branches; /* branch_count, the root first; owned */
    struct mesh_leaf *leaves;     /* leaf_count; owned */
    size_t branch_count, leaf_count;
    uint32_t *triangles; /* leaf_count x MESH_SLOTS: which of the mesh's triangles is in a slot, or
                            MESH_NO_TRIANGLE; owned */
    uint32_t levels;     /* branches on the longest way from the root to a leaf, 1...MESH_LEVELS */
};

/* Builds the hierarchy of count triangles (1...MESH_TRIANGLES_MAX) by the surface-area heuristic
 * over bins of the triangles' middles (Wald 2007). The same triangles give the same hierarchy
 * everywhere. vertices: triples of finite coordinates, m; corners: three numbers of vertices a
 * triangle; radius: m, about the origin, holds all vertices. Errors: MEMORY. On failure *hierarchy
 * is empty. */
sonject_status mesh_hierarchy_build(struct report *report, const float *vertices,
                                    const uint32_t *corners, size_t count, float radius,
                                    struct mesh_hierarchy *hierarchy);
void mesh_hierarchy_clear(struct mesh_hierarchy *hierarchy);

#endif
