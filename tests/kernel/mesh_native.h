/* The probe of meshes compiled as plain C of one lane and as native vectors of 8. */
#ifndef SONJECT_TESTS_MESH_NATIVE_H
#define SONJECT_TESTS_MESH_NATIVE_H

#include "mesh/mesh.h"

enum mesh_question {
    MESH_NEAREST, /* probe_nearest, _blocked, _surface of mesh_probe.h */
    MESH_BLOCKED,
    MESH_SURFACE
};

/* Probe rays [first, last), multiples of 8. input, output: planes of `rays` elements. */
void mesh_native_one(const struct mesh *mesh, enum mesh_question question, const float *input,
                     float *output, uint32_t rays, uint32_t first, uint32_t last);
void mesh_native_wide(const struct mesh *mesh, enum mesh_question question, const float *input,
                      float *output, uint32_t rays, uint32_t first, uint32_t last);

#endif
