/* Triangles, which planes may cut. */
#include <math.h>
#include <string.h>

#include "scene/shapes/shape.h"

/* A triangle, with a corner more for each plane that cuts it. */
#define CORNERS_MAX (3 + SONJECT_CUTS_CAPACITY)

struct polygon {
    double corners[CORNERS_MAX][3];
    size_t count;
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void add_corner(struct polygon *polygon, const double corner[3])
{
    if (polygon->count < CORNERS_MAX) /* rounding must not make it one more */
        memcpy(polygon->corners[polygon->count++], corner, sizeof polygon->corners[0]);
}

/* Where an edge crosses the plane, below which its ends lie by so much. */
static void add_crossing(struct polygon *polygon, const double a[3], const double b[3],
                         double depth_a, double depth_b)
{
    double corner[3];
    for (int axis = 0; axis < 3; axis++)
        corner[axis] = a[axis] + (b[axis] - a[axis]) * depth_a / (depth_a - depth_b);
    add_corner(polygon, corner);
}

static void clip(struct polygon *polygon, const struct cut_plane *cut)
{
    const struct polygon whole = *polygon;
    polygon->count = 0;
    for (size_t i = 0; i < whole.count; i++) {
        const double *here = whole.corners[i];
        const double *next = whole.corners[(i + 1) % whole.count];
        const double depth = cut->offset_m - dot(cut->normal, here);
        const double next_depth = cut->offset_m - dot(cut->normal, next);
        if (depth >= 0.0)
            add_corner(polygon, here);
        if ((depth > 0.0 && next_depth < 0.0) || (depth < 0.0 && next_depth > 0.0))
            add_crossing(polygon, here, next, depth, next_depth);
    }
}

/* The largest p . v over the points p of a mesh's facets that lie within all the cuts; -INFINITY
 * where none do. Of a closed mesh that is what the solid left reaches too, for wherever the face of
 * a cut reaches farthest a facet ends it. */
static double extent_within(const struct mesh *mesh, const struct cut_plane *cuts,
                            uint32_t cut_count, const double v[3])
{
    double extent = -INFINITY;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        struct polygon polygon = {.count = 3};
        for (size_t k = 0; k < 3; k++)
            for (size_t axis = 0; axis < 3; axis++)
                polygon.corners[k][axis] = mesh->vertices[3 * mesh->corners[3 * i + k] + axis];
        for (uint32_t k = 0; k < cut_count; k++)
            clip(&polygon, &cuts[k]);
        for (size_t k = 0; k < polygon.count; k++)
            extent = fmax(extent, dot(polygon.corners[k], v));
    }
    return extent;
}

static double cut_extent(const struct shape_size *size, const double v[3])
{
    return extent_within(size->mesh, size->cuts, size->cut_count, v);
}

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

/* Whether something of a mesh is left, and not just where a plane touches it. */
static bool is_left(const struct shape_size *size)
{
    static const double upward[3] = {0.0, 0.0, 1.0};
    struct cut_plane cuts[SONJECT_CUTS_CAPACITY];
    for (uint32_t i = 0; i < size->cut_count; i++) {
        cuts[i] = size->cuts[i];
        cuts[i].offset_m -= 1e-9 * size->bounding_radius_m;
    }
    return isfinite(extent_within(size->mesh, cuts, size->cut_count, upward));
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

const struct shape shape_mesh = {
    .needs = SHAPE_HAS_MESH, .extent = extent, .cut_extent = cut_extent, .is_left = is_left};
