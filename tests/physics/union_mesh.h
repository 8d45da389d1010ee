/* A box with an upright cylinder sunk into its top, once as parts, once as the mesh of their union.
 */
#ifndef SONJECT_TESTS_UNION_MESH_H
#define SONJECT_TESTS_UNION_MESH_H

#include "bench.h"

/* Adds the object, in its own frame level on the seabed, with the default surface of bench_add.
 * is_mesh: as a watertight mesh whose round facets lie within 0.005 mm of the cylinder. */
void add_union(struct bench *bench, bool is_mesh);

#endif
