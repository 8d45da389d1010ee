/* The same rays through Embree, where it is installed. */
#ifndef SONJECT_TESTS_MESH_EMBREE_H
#define SONJECT_TESTS_MESH_EMBREE_H

#include <stdbool.h>

#include "mesh/mesh.h"

struct embree_scene;

/* NULL where Embree is not installed. *build_s: s of building its hierarchy on one core. */
struct embree_scene *embree_open(const struct mesh *mesh, double *build_s);
void embree_close(struct embree_scene *scene);

/* Packets of 16 over rays [first, last); planes as those of the probe (tests/kernel/mesh_probe.h).
 * Writes distances and triangles' numbers in the mesh. */
void embree_trace(struct embree_scene *scene, bool is_coherent, const float *input, float *output,
                  uint32_t rays, uint32_t first, uint32_t last);

#endif
