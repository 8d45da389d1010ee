/* Entry points of the tests: one work-item traces WIDTH rays. */
#include "mesh_probe.h"

#define FIRST_RAY (WIDTH * (uint)get_global_id(0))

__kernel void nearest(__global const struct mesh_record *mesh,
                      __global const struct mesh_branch *branches,
                      __global const struct mesh_leaf *leaves,
                      __global const struct mesh_corner_normals *normals,
                      __global const float *input, __global float *output, uint rays)
{
    probe_nearest(mesh_view_of(mesh, branches, leaves, normals), input, output, rays, FIRST_RAY);
}

__kernel void blocked(__global const struct mesh_record *mesh,
                      __global const struct mesh_branch *branches,
                      __global const struct mesh_leaf *leaves,
                      __global const struct mesh_corner_normals *normals,
                      __global const float *input, __global float *output, uint rays)
{
    probe_blocked(mesh_view_of(mesh, branches, leaves, normals), input, output, rays, FIRST_RAY);
}

__kernel void surface(__global const struct mesh_record *mesh,
                      __global const struct mesh_branch *branches,
                      __global const struct mesh_leaf *leaves,
                      __global const struct mesh_corner_normals *normals,
                      __global const float *input, __global float *output, uint rays)
{
    probe_surface(mesh_view_of(mesh, branches, leaves, normals), input, output, rays, FIRST_RAY);
}
