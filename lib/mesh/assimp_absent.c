#include "mesh/mesh_reader.h"

sonject_status assimp_read(struct report *report, const char *path, struct mesh_soup *soup)
{
    (void)soup;
    return report_failure(
        report, SONJECT_ERROR_UNSUPPORTED,
        "%s: this build reads meshes from .stl, .obj and .ply files only: convert "
        "it, or build with Assimp",
        path);
}
