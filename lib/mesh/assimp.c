#include <math.h>

#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "mesh/mesh_reader.h"

/* Adds one of the scene's meshes, whose vertices are numbered from its own 0. Points and lines are
 * passed over. */
static sonject_status add_mesh(struct report *report, const char *path, const struct aiMesh *mesh,
                               struct mesh_soup *soup)
{
    const size_t first = soup->vertices;
    for (unsigned i = 0; i < mesh->mNumVertices; i++) {
        const double position[3] = {(double)mesh->mVertices[i].x, (double)mesh->mVertices[i].y,
                                    (double)mesh->mVertices[i].z};
        if (!isfinite(position[0]) || !isfinite(position[1]) || !isfinite(position[2]))
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "%s: a coordinate is not a finite number; export the mesh again",
                                  path);
        if (!mesh_soup_add_vertex(soup, position))
            return mesh_soup_failure(report, path, soup);
    }
    for (unsigned i = 0; i < mesh->mNumFaces; i++) {
        const struct aiFace *face = &mesh->mFaces[i];
        uint32_t fan[2];
        for (unsigned k = 0; face->mNumIndices >= 3 && k < face->mNumIndices; k++) {
            if (face->mIndices[k] >= mesh->mNumVertices)
                return report_failure(report, SONJECT_ERROR_INPUT,
                                      "%s: a face has vertex number %u of %u", path,
                                      face->mIndices[k], mesh->mNumVertices);
            if (!mesh_soup_add_polygon_corner(soup, k, (uint32_t)(first + face->mIndices[k]), fan))
                return mesh_soup_failure(report, path, soup);
        }
    }
    return SONJECT_OK;
}

sonject_status assimp_read(struct report *report, const char *path, struct mesh_soup *soup)
{
    const struct aiScene *scene =
        aiImportFile(path, aiProcess_Triangulate | aiProcess_PreTransformVertices);
    if (!scene)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: %s", path, aiGetErrorString());
    sonject_status status = SONJECT_OK;
    for (unsigned i = 0; i < scene->mNumMeshes && status == SONJECT_OK; i++)
        status = add_mesh(report, path, scene->mMeshes[i], soup);
    aiReleaseImport(scene);
    return status;
}
