/* How far a mesh reaches that planes cut. */
#ifndef SONJECT_SCENE_CUT_MESH_H
#define SONJECT_SCENE_CUT_MESH_H

#include "scene/shape_size.h"

/* The largest p . v over the points p of a mesh's facets that lie within all the cuts, v of any
 * length; -INFINITY where none do. Of a closed mesh that is what the solid left reaches too, for
 * wherever the face of a cut reaches farthest a facet ends it. */
double cut_mesh_extent(const struct mesh *mesh, const struct cut_plane *cuts, uint32_t cut_count,
                       const double v[3]);

#endif
