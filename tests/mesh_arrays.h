/* Meshes made from arrays, as a reader makes them from a file. */
#ifndef SONJECT_TESTS_MESH_ARRAYS_H
#define SONJECT_TESTS_MESH_ARRAYS_H

#include <string.h>

#include "mesh/mesh.h"
#include "mesh/mesh_reader.h"

/* positions: vertices x 3; corners: triangles x 3 numbers of vertices. *mesh is for mesh_clear. */
static inline sonject_status mesh_from_arrays(struct report *report, const char *name,
                                              const double *positions, size_t vertices,
                                              const uint32_t *corners, size_t triangles,
                                              const struct mesh_options *options, struct mesh *mesh)
{
    /* the arrays are only read, in spite of the casts */
    const struct mesh_soup soup = {.report = report,
                                   .path = name,
                                   .positions = (double *)(uintptr_t)positions,
                                   .corners = (uint32_t *)(uintptr_t)corners,
                                   .vertices = vertices,
                                   .triangles = triangles};
    memset(mesh, 0, sizeof *mesh);
    mesh->options = *options;
    return mesh_of_soup(&soup, mesh);
}

#endif
