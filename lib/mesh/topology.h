/* How the triangles of a mesh hang together: whether they close, which side is outside, and the
 * normals of the smooth surface that they stand for. */
#ifndef SONJECT_MESH_TOPOLOGY_H
#define SONJECT_MESH_TOPOLOGY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

/* One unit normal a corner (3 * triangles, 3 numbers each; to be given to free()): the mean of the
 * facets around the corner's vertex that lie within `angle` rad of the corner's own facet, weighted
 * by the angles that they span there. Larger angles between facets are edges. A corner of a facet
 * without area, or at a vertex of more than 256 facets, has its facet's normal (0 0 0 for a facet
 * without area). Errors: MEMORY. */
sonject_status mesh_smooth_normals(struct report *report, const float *vertices,
                                   size_t vertex_count, const uint32_t *corners,
                                   size_t triangle_count, double angle, float **normals);

struct mesh_topology {
    size_t open_edges;    /* of one triangle */
    size_t crowded_edges; /* of three or more */
    size_t twisted_edges; /* of two triangles that cannot both show the same side (Moebius) */
    size_t turned;        /* triangles whose orientation was reversed */
    size_t pieces;        /* sets of triangles that hang together by edges of two */
    bool is_closed;       /* every edge is that of two triangles, run in opposite directions */
    uint32_t edge[2];     /* vertices of one edge that keeps it from being closed */
    double volume;        /* enclosed, cubic units; of a closed mesh only */
};

/* Finds the above, and orients the triangles (their second and third corners are swapped where
 * needed): neighbours alike; a piece that needed it outward; a mesh whose pieces all were
 * consistent but whose volume is negative, as a whole. So a cavity that its file orients inward
 * stays one. vertices: triples of coordinates; corners: three a triangle, none equal. Errors:
 * MEMORY. */
sonject_status mesh_topology_find(struct report *report, const float *vertices, size_t vertex_count,
                                  uint32_t *corners, size_t triangle_count,
                                  struct mesh_topology *topology);

#endif
