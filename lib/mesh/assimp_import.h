/* Meshes that Assimp reads, from memory. Implemented in C++; no exception leaves it. */
#ifndef SONJECT_MESH_ASSIMP_IMPORT_H
#define SONJECT_MESH_ASSIMP_IMPORT_H

#ifdef __cplusplus
extern "C" {
#endif

#include "mesh/soup.h"

/* Adds all meshes of the file's scene, each where its nodes put it, in the file's numbers and axes.
 * bytes: the whole file; path:
 * chooses the format by its extension and is named in messages; nothing is read from it, nor from
 * files that the bytes name. Errors: INPUT, MEMORY. */
sonject_status assimp_import(struct report *report, const char *path, const char *bytes,
                             size_t count, struct mesh_soup *soup);

#ifdef __cplusplus
}
#endif

#endif
