#include "mesh/mesh_store.h"

#include <string.h>

#define BYTES_MOST ((uint64_t)512 << 20)

static uint64_t bytes_of(const struct mesh *mesh)
{
    const struct mesh_hierarchy *hierarchy = &mesh->hierarchy;
    const uint64_t slots = (uint64_t)hierarchy->leaf_count * MESH_SLOTS;
    return 3 * (mesh->vertex_count * sizeof *mesh->vertices +
                mesh->triangle_count * sizeof *mesh->corners) +
           hierarchy->branch_count * sizeof *hierarchy->branches +
           hierarchy->leaf_count * sizeof *hierarchy->leaves +
           slots * sizeof *hierarchy->triangles +
           (mesh->normals ? slots * sizeof *mesh->normals : 0);
}

/* The rest moves up. */
static void remove_mesh(struct mesh_store *store, size_t number, struct mesh *mesh)
{
    *mesh = store->meshes[number];
    store->bytes -= bytes_of(mesh);
    store->count--;
    memmove(&store->meshes[number], &store->meshes[number + 1],
            (store->count - number) * sizeof *store->meshes);
}

bool mesh_store_take(struct mesh_store *store, const struct file_identity *file,
                     const struct mesh_options *options, struct mesh *mesh)
{
    for (size_t i = 0; i < store->count; i++)
        if (mesh_is_of(&store->meshes[i], file, options)) {
            remove_mesh(store, i, mesh);
            return true;
        }
    return false;
}

void mesh_store_give(struct mesh_store *store, struct mesh *mesh)
{
    const uint64_t bytes = bytes_of(mesh);
    while (store->count > 0 &&
           (store->count == MESH_STORE_MESHES || store->bytes + bytes > BYTES_MOST)) {
        struct mesh oldest;
        remove_mesh(store, 0, &oldest);
        mesh_clear(&oldest);
    }
    store->bytes += bytes;
    store->meshes[store->count++] = *mesh;
    memset(mesh, 0, sizeof *mesh);
}

void mesh_store_clear(struct mesh_store *store)
{
    for (size_t i = 0; i < store->count; i++)
        mesh_clear(&store->meshes[i]);
    memset(store, 0, sizeof *store);
}
