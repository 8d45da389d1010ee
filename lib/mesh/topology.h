/* How the triangles of a mesh hang together: whether they close, and which side is outside. */
#ifndef SONJECT_MESH_TOPOLOGY_H
#define SONJECT_MESH_TOPOLOGY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

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

/* Corners (3 * triangle + 0...2) sorted by the vertex that they are at: those of vertex v are
 * list[starts[v]] to list[starts[v + 1] - 1], in ascending order. Both to be given to free().
 * Errors: MEMORY. */
sonject_status mesh_corners_by_vertex(struct report *report, const uint32_t *vertex_of_corner,
                                      size_t corner_count, size_t vertex_count, uint32_t **starts,
                                      uint32_t **list);

#endif
