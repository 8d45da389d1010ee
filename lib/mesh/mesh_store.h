/* Meshes that are kept from scene to scene, so that their files are not read each time. */
#ifndef SONJECT_MESH_MESH_STORE_H
#define SONJECT_MESH_MESH_STORE_H

#include "mesh/mesh.h"

#define MESH_STORE_MESHES 256

/* Starts as all zeros, is for mesh_store_clear. One thread at a time. */
struct mesh_store {
    struct mesh meshes[MESH_STORE_MESHES]; /* owned; the one that was given last is the last */
    size_t count;
    uint64_t bytes; /* of all */
};

/* Moves a mesh of that file, as it now is, with those options out of the store into *mesh. False,
 * with nothing done, if there is none. */
bool mesh_store_take(struct mesh_store *store, const struct file_identity *file,
                     const struct mesh_options *options, struct mesh *mesh);

/* Moves a mesh into the store, which drops the oldest where it is full. *mesh is empty then. */
void mesh_store_give(struct mesh_store *store, struct mesh *mesh);
void mesh_store_clear(struct mesh_store *store);

#endif
