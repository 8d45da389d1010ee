#include "mesh/mesh.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "mesh/mesh_reader.h"
#include "mesh/topology.h"

/* Sizes that single precision holds with room for squares and products. */
#define RADIUS_LEAST_M 1e-6
#define RADIUS_MOST_M  1e6

/* How far apart the sides of a seam may be, of the bounding box's diagonal: what single precision
 * makes of one point is within a tenth of it. */
#define SEAM_SHARE 1e-6

void mesh_options_init(struct mesh_options *options)
{
    memset(options, 0, sizeof *options);
    options->unit_m = 1.0;
    for (int axis = 0; axis < 3; axis++)
        options->axes[axis] = axis + 1;
}

bool mesh_is_of(const struct mesh *mesh, const struct file_identity *file,
                const struct mesh_options *options)
{
    return mesh->file.device == file->device && mesh->file.number == file->number &&
           mesh->file.bytes == file->bytes && mesh->file.changed_s == file->changed_s &&
           mesh->file.changed_ns == file->changed_ns && mesh->options.unit_m == options->unit_m &&
           memcmp(mesh->options.axes, options->axes, sizeof options->axes) == 0 &&
           mesh->options.smooth_angle_rad == options->smooth_angle_rad;
}

void mesh_clear(struct mesh *mesh)
{
    free(mesh->vertices);
    free(mesh->corners);
    free(mesh->normals);
    free(mesh->name);
    mesh_hierarchy_clear(&mesh->hierarchy);
    memset(mesh, 0, sizeof *mesh);
}

/* Determinant of the map of axes; 0 unless it is made of 1, 2, 3. */
static int determinant(const int axes[3])
{
    int order[3];
    int sign = 1;
    for (int i = 0; i < 3; i++) {
        order[i] = axes[i] < 0 ? -axes[i] : axes[i];
        sign = axes[i] < 0 ? -sign : sign;
        if (order[i] < 1 || order[i] > 3)
            return 0;
    }
    if (order[0] == order[1] || order[1] == order[2] || order[2] == order[0])
        return 0;
    return order[1] == order[0] % 3 + 1 ? sign : -sign;
}

static sonject_status check_options(struct report *report, const char *name,
                                    const struct mesh_options *options)
{
    if (!(options->unit_m > 0.0) || !isfinite(options->unit_m))
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "%s: the unit of a mesh must be a length above 0", name);
    if (!(options->smooth_angle_rad >= 0.0) || options->smooth_angle_rad > 3.15)
        return report_failure(report, SONJECT_ERROR_ARGUMENT,
                              "%s: the angle of smooth normals must be 0 to 180 degrees", name);
    if (determinant(options->axes) == 1)
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_ARGUMENT, "%s: axes %d, %d, %d %s", name,
                          options->axes[0], options->axes[1], options->axes[2],
                          determinant(options->axes) == 0
                              ? "must be 1, 2 and 3 in some order, with a minus sign where reversed"
                              : "mirror the mesh: reverse one more or one less of them");
}

/* A coordinate of the file as the object's, m. */
static double coordinate(const struct mesh_soup *soup, size_t vertex, int axis,
                         const struct mesh_options *options)
{
    const int source = options->axes[axis];
    const double value = soup->positions[3 * vertex + (size_t)(abs(source) - 1)];
    return (source < 0 ? -value : value) * options->unit_m;
}

/* The bounding box of all vertices that triangles use, and its middle. */
static sonject_status find_centre(struct report *report, const char *name,
                                  const struct mesh_soup *soup, const struct mesh_options *options,
                                  struct mesh *mesh)
{
    double lower[3] = {DBL_MAX, DBL_MAX, DBL_MAX};
    double upper[3] = {-DBL_MAX, -DBL_MAX, -DBL_MAX};
    for (size_t i = 0; i < 3 * soup->triangles; i++) {
        for (int axis = 0; axis < 3; axis++) {
            const double value = coordinate(soup, soup->corners[i], axis, options);
            lower[axis] = value < lower[axis] ? value : lower[axis];
            upper[axis] = value > upper[axis] ? value : upper[axis];
        }
    }
    double square = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        const double half = 0.5 * upper[axis] - 0.5 * lower[axis];
        mesh->centre_m[axis] = lower[axis] + half;
        square += half * half;
    }
    if (sqrt(square) >= RADIUS_LEAST_M && sqrt(square) <= RADIUS_MOST_M)
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: the mesh is %g m across: check its unit", name, 2.0 * sqrt(square));
}

/* Brings the soup's vertices into the mesh's frame, welds those that are equal, or closer than the
 * tolerance, and keeps the triangles that have three corners left. */
static sonject_status weld_all(struct report *report, const char *name,
                               const struct mesh_soup *soup, const struct mesh_options *options,
                               double tolerance, struct mesh *mesh, struct mesh_soup *welded)
{
    struct weld weld = {NULL, 0, tolerance};
    uint32_t *numbers = allocate_array(soup->vertices, sizeof *numbers); /* + 1; 0: not yet met */
    bool has_memory = numbers != NULL;
    mesh->degenerate = 0;
    for (size_t i = 0; i < soup->triangles && has_memory; i++) {
        uint32_t corners[3];
        for (size_t k = 0; k < 3 && has_memory; k++) {
            const uint32_t vertex = soup->corners[3 * i + k];
            if (numbers[vertex] == 0) {
                double position[3];
                uint32_t number = 0;
                for (int axis = 0; axis < 3; axis++)
                    position[axis] = (double)(float)(coordinate(soup, vertex, axis, options) -
                                                     mesh->centre_m[axis]);
                has_memory = weld_vertex(&weld, welded, position, &number);
                numbers[vertex] = number + 1;
            }
            corners[k] = numbers[vertex] - 1;
        }
        if (!has_memory)
            break;
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
            mesh->degenerate++;
        else
            has_memory = mesh_soup_add_triangle(welded, corners[0], corners[1], corners[2]);
    }
    weld_clear(&weld);
    free(numbers);
    CHECK_MEMORY(report, has_memory, name);
    if (welded->triangles == 0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: none of its %zu triangles has an area: export the mesh again",
                              name, soup->triangles);
    return SONJECT_OK;
}

/* Takes over what was welded. */
static sonject_status copy_welded(struct report *report, const char *name, struct mesh_soup *welded,
                                  struct mesh *mesh)
{
    double square = 0.0;
    mesh->vertices = allocate_array(welded->vertices, 3 * sizeof *mesh->vertices);
    CHECK_MEMORY(report, mesh->vertices, name);
    mesh->vertex_count = welded->vertices;
    for (int axis = 0; axis < 3; axis++) {
        mesh->lower_m[axis] = FLT_MAX;
        mesh->upper_m[axis] = -FLT_MAX;
    }
    for (size_t i = 0; i < welded->vertices; i++) {
        double from_centre = 0.0;
        for (size_t axis = 0; axis < 3; axis++) {
            const double value = welded->positions[3 * i + axis];
            mesh->vertices[3 * i + axis] = (float)value;
            mesh->lower_m[axis] = fminf(mesh->lower_m[axis], (float)value);
            mesh->upper_m[axis] = fmaxf(mesh->upper_m[axis], (float)value);
            from_centre += value * value;
        }
        square = fmax(square, from_centre);
    }
    mesh->radius_m = nextafterf((float)sqrt(square), FLT_MAX);
    mesh->corners = welded->corners;
    mesh->triangle_count = welded->triangles;
    welded->corners = NULL;
    return SONJECT_OK;
}

/* Smooth normals in the order of the leaves' slots. */
static sonject_status set_normals(struct report *report, double angle, struct mesh *mesh)
{
    float *normals;
    const size_t slots = mesh->hierarchy.leaf_count * MESH_SLOTS;
    sonject_status status =
        mesh_smooth_normals(report, mesh->vertices, mesh->vertex_count, mesh->corners,
                            mesh->triangle_count, angle, &normals);
    if (status != SONJECT_OK)
        return status;
    mesh->normals = allocate_array(slots, sizeof *mesh->normals);
    if (!mesh->normals)
        status = report_out_of_memory(report, "the normals of a mesh");
    for (size_t slot = 0; mesh->normals && slot < slots; slot++) {
        const uint32_t triangle = mesh->hierarchy.triangles[slot];
        if (triangle != MESH_NO_TRIANGLE)
            memcpy(&mesh->normals[slot], &normals[9 * (size_t)triangle], sizeof *mesh->normals);
    }
    free(normals);
    return status;
}

/* Vertices and triangles, and how they hang together. */
static sonject_status weld_and_orient(struct report *report, const char *name,
                                      const struct mesh_soup *soup,
                                      const struct mesh_options *options, double tolerance,
                                      struct mesh *mesh)
{
    struct mesh_soup welded;
    memset(&welded, 0, sizeof welded);
    free(mesh->vertices);
    free(mesh->corners);
    mesh->vertices = NULL;
    mesh->corners = NULL;
    sonject_status status = weld_all(report, name, soup, options, tolerance, mesh, &welded);
    THEN(status, copy_welded(report, name, &welded, mesh));
    mesh_soup_clear(&welded);
    return status == SONJECT_OK
               ? mesh_topology_find(report, mesh->vertices, mesh->vertex_count, mesh->corners,
                                    mesh->triangle_count, &mesh->topology)
               : status;
}

/* Only a mesh that is open is looked at for a seam, so that no thin wall of another is touched. */
static sonject_status close_seams(struct report *report, const char *name,
                                  const struct mesh_soup *soup, const struct mesh_options *options,
                                  struct mesh *mesh)
{
    double square = 0.0;
    const size_t vertices = mesh->vertex_count;
    for (int axis = 0; axis < 3; axis++) {
        const double side = (double)mesh->upper_m[axis] - (double)mesh->lower_m[axis];
        square += side * side;
    }
    const sonject_status status =
        weld_and_orient(report, name, soup, options, SEAM_SHARE * sqrt(square), mesh);
    mesh->welded = vertices - mesh->vertex_count;
    return status;
}

static sonject_status prepare(struct report *report, const char *name, const struct mesh_soup *soup,
                              const struct mesh_options *options, struct mesh *mesh)
{
    mesh->options = *options;
    mesh->name = copy_text(name);
    CHECK_MEMORY(report, mesh->name, name);
    if (soup->triangles == 0)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: the mesh has no triangles", name);
    if (soup->triangles > MESH_TRIANGLES_MAX)
        return report_failure(
            report, SONJECT_ERROR_INPUT,
            "%s: %zu triangles are more than the %zu that a mesh may have: simplify "
            "it",
            name, soup->triangles, MESH_TRIANGLES_MAX);
    sonject_status status = find_centre(report, name, soup, options, mesh);
    THEN(status, weld_and_orient(report, name, soup, options, 0.0, mesh));
    if (status == SONJECT_OK && !mesh->topology.is_closed)
        status = close_seams(report, name, soup, options, mesh);
    if (status == SONJECT_OK) {
        mesh->volume_m3 = mesh->topology.volume;
        status = mesh_hierarchy_build(report, mesh->vertices, mesh->corners, mesh->triangle_count,
                                      mesh->radius_m, &mesh->hierarchy);
    }
    if (status == SONJECT_OK && options->smooth_angle_rad > 0.0)
        status = set_normals(report, options->smooth_angle_rad, mesh);
    return status;
}

sonject_status mesh_load(struct report *report, const char *path,
                         const struct mesh_options *options, struct mesh *mesh)
{
    struct mesh_soup soup;
    memset(&soup, 0, sizeof soup);
    memset(mesh, 0, sizeof *mesh);
    sonject_status status = check_options(report, path, options);
    THEN(status, file_identify(report, path, &mesh->file));
    THEN(status, mesh_file_read(report, path, &soup));
    THEN(status, prepare(report, path, &soup, options, mesh));
    mesh_soup_clear(&soup);
    if (status != SONJECT_OK)
        mesh_clear(mesh);
    return status;
}

static sonject_status check_arrays(struct report *report, const char *name,
                                   const struct mesh_soup *soup)
{
    for (size_t i = 0; i < 3 * soup->vertices; i++)
        if (!isfinite(soup->positions[i]))
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "%s: a coordinate of vertex %zu is not a finite number", name,
                                  i / 3);
    for (size_t i = 0; i < 3 * soup->triangles; i++)
        if (soup->corners[i] >= soup->vertices)
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "%s: triangle %zu has vertex %lu of %zu", name, i / 3,
                                  (unsigned long)soup->corners[i], soup->vertices);
    return SONJECT_OK;
}

sonject_status mesh_from_arrays(struct report *report, const char *name, const double *positions,
                                size_t vertex_count, const uint32_t *corners, size_t triangle_count,
                                const struct mesh_options *options, struct mesh *mesh)
{
    struct mesh_soup soup;
    memset(&soup, 0, sizeof soup);
    memset(mesh, 0, sizeof *mesh);
    /* read only */
    soup.positions = (double *)(uintptr_t)positions;
    soup.corners = (uint32_t *)(uintptr_t)corners;
    soup.vertices = vertex_count;
    soup.triangles = triangle_count;
    sonject_status status = check_options(report, name, options);
    THEN(status, check_arrays(report, name, &soup));
    THEN(status, prepare(report, name, &soup, options, mesh));
    if (status != SONJECT_OK)
        mesh_clear(mesh);
    return status;
}

sonject_status mesh_require_closed(struct report *report, const char *name, const struct mesh *mesh)
{
    const struct mesh_topology *topology = &mesh->topology;
    if (topology->is_closed)
        return SONJECT_OK;
    const float *vertex = &mesh->vertices[3 * (size_t)topology->edge[0]];
    return report_failure(
        report, SONJECT_ERROR_INPUT,
        "%s: the mesh does not enclose a volume: %zu edges belong to one triangle, %zu to more "
        "than "
        "two, %zu are twisted, one of them at (%g, %g, %g) m: close it in a mesh editor",
        name, topology->open_edges, topology->crowded_edges, topology->twisted_edges,
        (double)vertex[0] + mesh->centre_m[0], (double)vertex[1] + mesh->centre_m[1],
        (double)vertex[2] + mesh->centre_m[2]);
}

struct mesh_record mesh_record_of(const struct mesh *mesh, uint32_t first_branch,
                                  uint32_t first_leaf, uint32_t first_normals)
{
    struct mesh_record record;
    memset(&record, 0, sizeof record);
    record.first_branch = first_branch;
    record.branches = (uint32_t)mesh->hierarchy.branch_count;
    record.first_leaf = first_leaf;
    record.leaves = (uint32_t)mesh->hierarchy.leaf_count;
    record.first_normals = first_normals;
    record.is_smooth = mesh->normals != NULL;
    record.radius = mesh->radius_m;
    record.is_sheet = !mesh->topology.is_closed;
    return record;
}
