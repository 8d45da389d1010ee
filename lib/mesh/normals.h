/* Normals of the smooth surface that a mesh stands for. */
#ifndef SONJECT_MESH_NORMALS_H
#define SONJECT_MESH_NORMALS_H

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

#endif
