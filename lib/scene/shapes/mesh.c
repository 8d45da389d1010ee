/* Meshes of triangles. */
#include <math.h>

#include "scene/shapes/shape.h"

static double extent(const struct shape_size *size, const double v[3])
{
    const struct mesh *mesh = size->mesh;
    double farthest = -INFINITY;
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        const float *p = &mesh->vertices[3 * i];
        farthest = fmax(farthest, p[0] * v[0] + p[1] * v[1] + p[2] * v[2]);
    }
    return farthest;
}

void shape_size_of_mesh(struct shape_size *size, const struct mesh *mesh)
{
    size->mesh = mesh;
    size->half_length_m = mesh->upper_m[0];
    size->half_width_m = mesh->upper_m[1];
    size->half_height_m = mesh->upper_m[2];
    size->radius_about_nose_m = hypot(size->half_width_m, size->half_height_m);
    size->bounding_radius_m = (1.0 + 1e-6) * mesh->radius_m;
}

const struct shape shape_mesh = {.needs = SHAPE_HAS_MESH, .extent = extent};
