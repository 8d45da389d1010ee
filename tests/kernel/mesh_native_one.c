#include "kernel/mesh_native.h"
#include "kernel/mesh_probe.h"

#ifndef MESH_NATIVE
#define MESH_NATIVE mesh_native_one
#endif

void MESH_NATIVE(const struct mesh *mesh, enum mesh_question question, const float *input,
                 float *output, uint32_t rays, uint32_t first, uint32_t last)
{
    const struct mesh_record record = mesh_record_of(mesh, 0, 0, 0);
    const struct mesh_view view =
        mesh_view_of(&record, mesh->hierarchy.branches, mesh->hierarchy.leaves, mesh->normals);
    for (uint32_t ray = first; ray < last; ray += WIDTH) {
        if (question == MESH_NEAREST)
            probe_nearest(view, input, output, rays, ray);
        else if (question == MESH_BLOCKED)
            probe_blocked(view, input, output, rays, ray);
        else
            probe_surface(view, input, output, rays, ray);
    }
}
