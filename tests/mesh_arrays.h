/* Meshes made from arrays, as a reader makes them from a file. */
#ifndef SONJECT_TESTS_MESH_ARRAYS_H
#define SONJECT_TESTS_MESH_ARRAYS_H

#include "claims.h"
#include "kernel/mesh_samples.h"
#include "mesh/mesh.h"
#include "mesh/mesh_reader.h"

/* Makes a mesh of a sample whose unit is unit_m. *mesh is for mesh_clear. */
static inline void mesh_of_sample(const struct mesh_sample *sample, double unit_m,
                                  double smooth_angle_rad, struct mesh *mesh)
{
    struct report report = {.host = NULL};
    const struct mesh_soup soup = {.report = &report,
                                   .path = "sample",
                                   .positions = sample->positions,
                                   .corners = sample->corners,
                                   .vertices = sample->vertices,
                                   .triangles = sample->triangles};
    memset(mesh, 0, sizeof *mesh);
    mesh_options_init(&mesh->options);
    mesh->options.unit_m = unit_m;
    mesh->options.smooth_angle_rad = smooth_angle_rad;
    EXPECT_OK(&report, mesh_of_soup(&soup, mesh));
}

#endif
