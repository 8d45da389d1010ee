#include "mesh/normals.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "mesh/topology.h"

#define FACETS_MAX 256

/* A facet's unit normal and the angles at its corners. */
struct facet {
    float normal[3];
    float angles[3];
};

static void difference(const float *from, const float *to, double out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (double)to[axis] - (double)from[axis];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static void measure_facet(const float *a, const float *b, const float *c, struct facet *facet)
{
    double ab[3], ac[3], bc[3], normal[3];
    difference(a, b, ab);
    difference(a, c, ac);
    difference(b, c, bc);
    cross(ab, ac, normal);
    const double twice_area = sqrt(dot(normal, normal));
    memset(facet, 0, sizeof *facet);
    if (!(twice_area > 0.0))
        return;
    for (int axis = 0; axis < 3; axis++)
        facet->normal[axis] = (float)(normal[axis] / twice_area);
    facet->angles[0] = (float)atan2(twice_area, dot(ab, ac));
    facet->angles[1] = (float)atan2(twice_area, -dot(ab, bc));
    facet->angles[2] = (float)atan2(twice_area, dot(ac, bc));
}

/* The mean of the facets at corners list[0...count - 1] that are near facet number own. */
static void mean_normal(const struct facet *facets, const uint32_t *list, size_t count, size_t own,
                        float least_cosine, float *normal)
{
    const float *facing = facets[own].normal;
    double sum[3] = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < count; i++) {
        const struct facet *facet = &facets[list[i] / 3];
        const float cosine = facing[0] * facet->normal[0] + facing[1] * facet->normal[1] +
                             facing[2] * facet->normal[2];
        if (cosine < least_cosine)
            continue;
        for (int axis = 0; axis < 3; axis++)
            sum[axis] += (double)(facet->angles[list[i] % 3] * facet->normal[axis]);
    }
    const double length = sqrt(dot(sum, sum));
    for (int axis = 0; axis < 3; axis++)
        normal[axis] = length > 0.0 ? (float)(sum[axis] / length) : facing[axis];
}

sonject_status mesh_smooth_normals(struct report *report, const float *vertices,
                                   size_t vertex_count, const uint32_t *corners,
                                   size_t triangle_count, double angle, float **normals)
{
    struct facet *facets = allocate_array(triangle_count, sizeof *facets);
    uint32_t *starts = NULL;
    uint32_t *list = NULL;
    *normals = allocate_array(3 * triangle_count, 3 * sizeof **normals);
    const sonject_status status = facets && *normals
                                      ? mesh_corners_by_vertex(report, corners, 3 * triangle_count,
                                                               vertex_count, &starts, &list)
                                      : report_out_of_memory(report, "the normals of a mesh");
    if (status == SONJECT_OK) {
        for (size_t i = 0; i < triangle_count; i++)
            measure_facet(&vertices[3 * (size_t)corners[3 * i]],
                          &vertices[3 * (size_t)corners[3 * i + 1]],
                          &vertices[3 * (size_t)corners[3 * i + 2]], &facets[i]);
        const float least_cosine = (float)cos(angle);
        for (size_t i = 0; i < 3 * triangle_count; i++) {
            const uint32_t first = starts[corners[i]];
            const size_t count = starts[corners[i] + 1] - first;
            float *normal = *normals + 3 * i;
            if (count > FACETS_MAX)
                memcpy(normal, facets[i / 3].normal, 3 * sizeof *normal);
            else
                mean_normal(facets, list + first, count, i / 3, least_cosine, normal);
        }
    } else {
        free(*normals);
        *normals = NULL;
    }
    free(facets);
    free(starts);
    free(list);
    return status;
}
